"""Pictures and movies of a run; the only use of pyvista's renderer. The room computes nothing."""
