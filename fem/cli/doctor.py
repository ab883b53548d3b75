"""`doctor`: what this machine has, and the line that mends what is missing."""

import json
import os
import platform
import shutil
from importlib import metadata
from pathlib import Path
from typing import Any

from fem.cli.console import AsJson
from fem.render.opengl import MEND, probe_rendering

DISTRIBUTIONS = (
    "unanchored",
    "numpy",
    "scipy",
    "numba",
    "scikit-fem",
    "meshio",
    "pyvista",
    "matplotlib",
    "pydantic",
    "cyclopts",
    "rich",
    "jinja2",
    "filelock",
)
MEND_PACKAGES = "python -m pip install --upgrade unanchored"
LEAST_FREE_GB = 1.0


def doctor(
    *,
    as_json: AsJson = False,
) -> None:
    """Versions, rendering, threads and disk, and the command that mends what is missing."""
    versions = {name: _version(name) for name in DISTRIBUTIONS}
    rendering = probe_rendering()
    free = shutil.disk_usage(Path.cwd()).free / 1e9
    remedies = []
    if missing := [name for name, version in versions.items() if version is None]:
        remedies.append(f"missing: {', '.join(missing)}; {MEND_PACKAGES}")
    if rendering is not None:
        remedies.append(f"no pictures and movies (runs are not affected): {rendering}; {MEND}")
    if free < LEAST_FREE_GB:
        remedies.append(f"only {free:.2f} GB free in {Path.cwd()}: write elsewhere with --out")
    report: dict[str, Any] = {
        "python": platform.python_version(),
        "platform": platform.platform(),
        "versions": versions,
        "rendering": rendering is None,
        "threads": available_threads(),
        "disk_free_GB": round(free, 2),
        "remedies": remedies,
    }
    print(json.dumps(report, indent=2) if as_json else _page(report))


def available_threads() -> int:
    """Processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _version(name: str) -> str | None:
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


def _page(report: dict[str, Any]) -> str:
    lines = [f"python {report['python']} on {report['platform']}"]
    lines += [f"  {name:<12} {version or 'missing'}" for name, version in report["versions"].items()]
    lines += [
        f"  {'rendering':<12} {'works' if report['rendering'] else 'does not work'}",
        f"  {'threads':<12} {report['threads']}",
        f"  {'disk':<12} {report['disk_free_GB']:g} GB free here",
    ]
    return "\n".join(lines + [""] + (report["remedies"] or ["nothing is missing"]))
