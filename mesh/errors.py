"""Errors of the mesh package, all of them ValueErrors."""


class MeshError(ValueError):
    """An invalid container, fill, mesh or mesh file."""


class MeshQualityError(MeshError):
    """A mesh with a cell too distorted for a finite element; the message gives the worst cell."""
