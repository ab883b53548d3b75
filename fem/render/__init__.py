"""Pictures and movies of a run; the only use of pyvista's renderer. No result is computed here."""
