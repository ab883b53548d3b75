"""Where material is: geometry, section and fill, mesh, quality, files. No time, no forces."""
