"""`doctor`: what this machine has, and the line that mends what is missing.

Pictures need an OpenGL library. Where there is none, rendering ends the whole process, so it is tried in
a process of its own.
"""

import json
import os
import platform
import shutil
import subprocess
import sys
from importlib import metadata
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

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
)
MEND_PICTURES = "apt-get install -y libegl1 libgl1-mesa-dri"
MEND_PACKAGES = "python -m pip install --upgrade unanchored"
RENDER_SECONDS = 120
RENDER = """
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(64, 64))
plotter.add_mesh(pyvista.Sphere())
assert plotter.screenshot(return_img=True).std() > 0.0
"""
LEAST_FREE_GB = 1.0


def doctor(
    *,
    as_json: Annotated[
        bool, Parameter(name="--json", negative=(), show_default=False, help="Print JSON.")
    ] = False,
) -> None:
    """Versions, rendering, threads and disk, and the command that mends what is missing."""
    versions = {name: _version(name) for name in DISTRIBUTIONS}
    rendering = probe_rendering()
    free = shutil.disk_usage(Path.cwd()).free / 1e9
    remedies = []
    if missing := [name for name, version in versions.items() if version is None]:
        remedies.append(f"missing: {', '.join(missing)}; {MEND_PACKAGES}")
    if rendering is not None:
        remedies.append(f"no pictures and movies (runs are not affected): {rendering}; {MEND_PICTURES}")
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


def probe_rendering() -> str | None:
    """None if a picture can be rendered here, else why not; tried in a process of its own."""
    try:
        result = subprocess.run(
            [sys.executable, "-c", RENDER],
            capture_output=True,
            text=True,
            timeout=RENDER_SECONDS,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return f"rendering did not end within {RENDER_SECONDS} s"
    if result.returncode == 0:
        return None
    if result.returncode < 0:
        return f"rendering ended with signal {-result.returncode}"
    lines = result.stderr.strip().splitlines()
    return f"rendering failed ({lines[-1] if lines else 'without a message'})"


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
