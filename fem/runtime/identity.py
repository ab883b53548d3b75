"""Identity of the program: its version, its sources, and the libraries that its results depend on."""

import hashlib
import platform
import shlex
from functools import cache
from importlib import metadata
from pathlib import Path

PACKAGES = ("fem", "mesh", "contact")
DISTRIBUTIONS = ("unanchored", "numpy", "scipy", "scikit-fem", "numba", "meshio")

_version = cache(metadata.version)


def versions() -> dict[str, str]:
    """Versions of the program and of the libraries that its results depend on."""
    return {"python": platform.python_version()} | {name: _version(name) for name in DISTRIBUTIONS}


@cache
def program_identity() -> dict[str, str]:
    """Versions, machine, digest of sources and shipped files: runs resume only where they are the same."""
    digest = hashlib.sha256()
    root = Path(__file__).parents[2]
    files = (path for package in PACKAGES for path in (root / package).rglob("*"))
    for source in sorted(path for path in files if path.suffix in (".py", ".toml")):
        digest.update(source.relative_to(root).as_posix().encode())
        digest.update(source.read_bytes())
    return versions() | {"machine": platform.machine(), "sources": digest.hexdigest()[:16]}


def command_line(*words: str, allow_outside: bool = False) -> str:
    """A command of this program, for people to copy."""
    return shlex.join(("python", "-m", "fem", *words, *["--allow-outside"] * allow_outside))
