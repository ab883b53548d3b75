"""Whether pictures can be rendered here: tried in a process of its own, for where no OpenGL library is rendering
ends the whole process."""

import subprocess
import sys

MEND_PICTURES = "apt-get install -y libegl1 libgl1-mesa-dri"
MEND = f"as root, on Debian or Ubuntu: {MEND_PICTURES}"
RENDER_SECONDS = 120
RENDER = """
import pyvista
plotter = pyvista.Plotter(off_screen=True, window_size=(64, 64))
plotter.add_mesh(pyvista.Sphere())
assert plotter.screenshot(return_img=True).std() > 0.0
"""


class RenderingError(RuntimeError):
    """No picture can be made here; the message says why and what to install."""


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
        # VTK looks for the library when it renders, and ends the process where it finds none.
        return f"no OpenGL library that works was found (the trial ended with signal {-result.returncode})"
    lines = result.stderr.strip().splitlines()
    return f"rendering failed ({lines[-1] if lines else 'without a message'})"


def require_rendering() -> None:
    """Raises RenderingError, naming the packages to install, where nothing can be rendered."""
    reason = probe_rendering()
    if reason is not None:
        raise RenderingError(f"no pictures here (nothing else is affected): {reason}; {MEND}")
