"""Probe for OpenGL: whether pictures can be rendered on this machine.

The probe runs in a process of its own, because rendering without an OpenGL library ends the process.
"""

import subprocess
import sys

MEND_PICTURES = "apt-get install -y libegl1 libgl1-mesa-dri"
MEND = f"as root, on Debian or Ubuntu: {MEND_PICTURES}"
PROBE_SECONDS = 120
RENDER = """
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(64, 64))
plotter.add_mesh(pyvista.Sphere())
assert plotter.screenshot(return_img=True).std() > 0.0
"""


class RenderingError(RuntimeError):
    """Pictures cannot be rendered here; the message gives the reason and the packages to install."""


def probe_rendering() -> str | None:
    """None if a picture can be rendered, else the reason why not."""
    command = [sys.executable, "-c", RENDER]
    try:
        result = subprocess.run(command, capture_output=True, text=True, timeout=PROBE_SECONDS, check=False)
    except subprocess.TimeoutExpired:
        return f"the rendering test did not end within {PROBE_SECONDS} s"
    if result.returncode < 0:
        return (
            f"no working OpenGL library was found (the rendering test ended with signal {-result.returncode})"
        )
    if result.returncode > 0:
        lines = result.stderr.strip().splitlines()
        return f"the rendering test failed ({lines[-1] if lines else 'without a message'})"
    return None


def require_rendering() -> None:
    """Raises RenderingError, naming the packages to install, if nothing can be rendered."""
    reason = probe_rendering()
    if reason is not None:
        raise RenderingError(f"pictures cannot be rendered here (nothing else is affected): {reason}; {MEND}")
