"""`picture` and `movie`: one instant of a run, or a recorded motion and its response spectrum; a run as GIF or MP4."""

import importlib
import io
import math
from pathlib import Path
from typing import Annotated, Literal

from cyclopts import Parameter

from fem.case.data_files import split_channel
from fem.case.files import kind_of, other_kind
from fem.case.plausible import doubts
from fem.case.validation import CaseError
from fem.cli.console import ELSEWHERE_TO, Quiet
from fem.records.files import read_record
from fem.records.processing import Baseline, Processing, baseline_change, processed
from fem.records.record import Component
from fem.render.opengl import require_rendering
from fem.results.disk import BYTES_BESIDE
from fem.results.errors import require_writable, writing_into
from fem.results.reader import open_run
from fem.run.expected import say_expected
from fem.runtime.own_files import make_folder, place_in, write_atomically
from fem.runtime.progress import ScreenReporter
from fem.runtime.terminal import say

SUFFIXES = (".png", ".svg")
OF_A_FRAME_S = 0.09  #: to draw it, without a graphics card [s]


def picture(
    run: Annotated[str, Parameter(name="RUN")],
    /,
    *,
    time: float | None = None,
    unit: Literal["g", "m/s2", "cm/s2", "gal", "mm/s2", "m"] | None = None,
    sample_interval: float | None = None,
    quantity: Annotated[
        Literal["acceleration", "displacement"], Parameter(show_default=False)
    ] = "acceleration",
    baseline: Annotated[Baseline, Parameter(show_default=False)] = "none",
    to: Path | None = None,
) -> None:
    """Draw the deformed container on its floor, or a recorded motion with its response spectrum.

    Of a run: stress, contact pressure, time and rotation ratio. Of a motion file: acceleration, velocity, displacement
    and pseudo-acceleration for 5 % of damping.

    Args:
        run: Folder of a run, such as outputs/my-stack, or a motion file; FILE#CHANNEL.
        time: Instant [s]; default: the frame of the largest rotation.
        unit: Of a motion file that does not state it.
        sample_interval: Of a motion file of one column [s].
        quantity: Of a motion file.
        baseline: Of a motion file.
        to: The PNG, of a motion also SVG; default: figures/picture_TIME.png of the run, FILE.png.
    """
    path, channel = split_channel(Path(), run)
    if not path.is_dir() and (kind := kind_of(path)):
        raise CaseError(other_kind(path, kind))
    if path.is_file():
        if time is not None:
            raise CaseError("--time is for a run, and this is a motion file")
        record = read_record(path, unit=unit, sample_interval=sample_interval)
        components = [candidate for candidate in record.components if candidate.quantity == quantity][:3]
        if channel or not components:  # raises where it holds none, with what it holds
            components = [record.component("horizontal", quantity=quantity, channel=channel)]
        processing = Processing(baseline=baseline)
        made = [processed(component, processing) for component in components]
        noted = [
            f"{component.name or path.name}: {note}"
            for component, motion in zip(components, made, strict=True)
            for note in (*component.notes, *doubts(path.name, component, motion, scale=1.0, confirmed=False))
        ]
        say(_write_motion(made, path, to))
        say("\n".join(noted), end="\n" * bool(noted))
        for component in components:
            change = baseline_change(component, processing)
            if change is not None and change.is_said:
                say(f"{component.name or path.name}: {change.in_words}")
        return
    if not path.exists():
        raise CaseError(f"{run}: no such file or folder; give the folder of a run, or a motion file")
    if (unit, sample_interval, quantity, baseline) != (None, None, "acceleration", "none"):
        raise CaseError(
            "--unit, --sample-interval, --quantity and --baseline are for a motion file, and this is a run"
        )
    opened = open_run(Path(run))
    _ = opened.fields  # raises where there are no frames to draw
    require_writable(to.parent if to else Path(run), ELSEWHERE_TO)
    require_rendering()
    # Loads pyvista.
    pictures = importlib.import_module("fem.render.picture")
    with writing_into(to.parent if to else Path(run), ELSEWHERE_TO):
        say(pictures.write_picture(opened, time=time, path=to))


def _write_motion(components: list[Component], path: Path, to: Path | None) -> Path:
    """Draw a record, in the present folder, or where it is asked for."""
    target = to if to is not None else Path(f"{path.stem}.png")
    if target.suffix.lower() not in SUFFIXES:
        raise CaseError(f"--to {target}: a motion is drawn as {' or '.join(SUFFIXES)}")
    # Loads matplotlib.
    figures, style = (importlib.import_module(f"fem.figures.{name}") for name in ("motions", "style"))
    figure, drawn = figures.record_figure(components, path.name), io.BytesIO()
    with writing_into(target.parent, ELSEWHERE_TO):
        if target.suffix.lower() == ".svg":
            write_atomically(target, style.svg_of(figure))
        else:
            figure.savefig(drawn, dpi=160)
            write_atomically(target, drawn.getvalue())
    return target


def movie(
    run: Annotated[Path, Parameter(name="RUN")],
    /,
    *,
    to: Path | None = None,
    begin: Annotated[float, Parameter(name="--from")] = 0.0,
    until: float = math.inf,
    fps: float = 25.0,
    quiet: Quiet = False,
) -> None:
    """Animate the frames of a run in real time; MP4 needs imageio-ffmpeg.

    Args:
        run: Folder of a run, such as outputs/my-stack.
        to: A .gif or .mp4; default: its figures/movie.gif.
        begin: Begin at this time of the run [s].
        until: End at this time of the run [s].
        fps: Most frames a second.
    """
    opened, path = open_run(run), to or run / "figures/movie.gif"
    count = len(opened.fields)  # raises where there are no frames to draw
    require_writable(to.parent if to else run, ELSEWHERE_TO, BYTES_BESIDE)
    require_rendering()
    say_expected(ScreenReporter(quiet=quiet), f"up to {count} frames", OF_A_FRAME_S * count)
    with writing_into(path.parent, ELSEWHERE_TO):
        if to is None:
            place_in(run, "figures/movie.gif")
        else:
            make_folder(path.parent)
        film = importlib.import_module("fem.render.picture")  # loads pyvista
        film.write_movie(opened, path, begin=begin, until=until, rate=fps)
    say(path)
