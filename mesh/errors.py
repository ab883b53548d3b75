"""What the mesh package refuses: one family of errors, all of them ValueErrors with a way out."""


class MeshError(ValueError):
    """A container, a fill, a mesh or a mesh file that cannot be what it claims to be."""


class MeshQualityError(MeshError):
    """A mesh with a cell too distorted to carry a finite element; the message gives the worst cell."""
