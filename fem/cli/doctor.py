"""`doctor`: missing dependencies of this machine, and how to install them."""

import json
import platform
import shutil
from importlib import metadata
from pathlib import Path
from typing import Any

from fem.cli.console import AsJson
from fem.render.opengl import MEND, probe_rendering
from fem.runtime.terminal import say
from fem.runtime.threads import cores

DISTRIBUTIONS = (
    *("unanchored", "numpy", "scipy", "numba", "scikit-fem", "meshio", "pyvista", "matplotlib"),
    *("pydantic", "cyclopts", "rich", "jinja2", "imageio", "filelock"),
)
INSTALL_PACKAGES = "python -m pip install --upgrade unanchored"
LEAST_FREE_GB = 1.0


def doctor(*, as_json: AsJson = False) -> None:
    """Report versions, rendering, cores and free disk, and how to install what is missing."""
    versions = {name: _version(name) for name in DISTRIBUTIONS}
    rendering = probe_rendering()
    free = shutil.disk_usage(Path.cwd()).free / 1e9
    remedies = []
    if missing := [name for name, version in versions.items() if version is None]:
        remedies.append(f"missing: {', '.join(missing)}; {INSTALL_PACKAGES}")
    if rendering is not None:
        remedies.append(f"pictures and movies do not work (runs do): {rendering}; {MEND}")
    if free < LEAST_FREE_GB:
        remedies.append(f"only {free:.2f} GB free in {Path.cwd()}: write elsewhere with --out")
    report: dict[str, Any] = {
        "python": platform.python_version(),
        "platform": platform.platform(),
        "versions": versions,
        "rendering": rendering is None,
        "threads": cores(),
        "disk_free_GB": round(free, 2),
        "remedies": remedies,
    }
    say(json.dumps(report, indent=2) if as_json else _page(report))


def _version(name: str) -> str | None:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


def _page(report: dict[str, Any]) -> str:
    rows = {name: version or "missing" for name, version in report["versions"].items()}
    rows |= {"rendering": "works" if report["rendering"] else "does not work", "threads": report["threads"]}
    rows |= {"disk": f"{report['disk_free_GB']:g} GB free here"}
    lines = [
        f"python {report['python']} on {report['platform']}",
        *(f"  {k:<12} {v}" for k, v in rows.items()),
    ]
    return "\n".join(lines + [""] + (report["remedies"] or ["nothing is missing"]))
