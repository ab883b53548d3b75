"""Pictures and films of a container; the only door to pyvista's renderer. It steps nothing."""
