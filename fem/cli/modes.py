"""`modes`: elastic frequencies and shapes of the free container."""

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Annotated

from fem.case.case import CaseError, load_case
from fem.cli.console import ELSEWHERE_OUT, WHOLE, AsJson, CaseName, Overrides
from fem.figures.modes import modes_figure
from fem.figures.style import house_style, svg_of
from fem.model.container import discretise
from fem.model.geometry import build_container
from fem.results.errors import require_writable, writing_into
from fem.run.expected import say_expected
from fem.runtime.own_files import write_atomically
from fem.runtime.progress import ScreenReporter
from fem.runtime.terminal import say
from fem.solid.assembly import assemble
from fem.solid.modes import ElasticModes, elastic_mode_table, elastic_modes, write_modes

RIGID_MODES, SHOWN = 3, 20
OF_AN_UNKNOWN_S = 4e-6  #: processor time of a mode and an unknown [s]


def modes(
    case: CaseName = None,
    /,
    *,
    count: Annotated[int | None, WHOLE] = None,
    out: Path | None = None,
    overrides: Overrides = (),
    as_json: AsJson = False,
) -> None:
    """Print elastic frequencies of the free container; the shapes go to modes.vtu and modes.svg.

    Args:
        count: Number of modes; default: solver.elastic_modes, or 20.
        out: Folder of the results; default: outputs/NAME/modes.
    """
    loaded = load_case(case, overrides)
    folder = out if out is not None else Path("outputs") / loaded.name / "modes"
    require_writable(folder, ELSEWHERE_OUT)
    modes_of: Callable[[int], ElasticModes]  #: the lowest ones of its free bodies
    if loaded.container.is_loose:
        stack = discretise(loaded.with_values({"solver.model": "rigid"}))
        elements, free, modes_of = stack.elements, [box.elements for box in stack.boxes], stack.lowest_modes
    else:
        elements = assemble(
            build_container(loaded),
            youngs_modulus=loaded.container.youngs_modulus_Pa,
            poisson_ratio=loaded.container.poisson_ratio,
            order=loaded.solver.order,
        )
        free, modes_of = [elements], partial(elastic_modes, elements)
    available = min(body.unknowns for body in free) - RIGID_MODES
    if count is not None and not 1 <= count <= available:
        raise CaseError(f"--count {count}: this mesh has from 1 to {available} elastic modes")
    # A case may keep no elastic modes, or more than a coarse mesh has.
    wanted = count or min(loaded.solver.elastic_modes or SHOWN, available)
    unknowns = sum(body.unknowns for body in free)
    say_expected(ScreenReporter(), f"{wanted} modes", OF_AN_UNKNOWN_S * wanted * unknowns)
    shapes = modes_of(wanted)
    with house_style():
        drawn = modes_figure(
            points=elements.nodes, cells=elements.cells, box=elements.box, modes=shapes, name=loaded.name
        )
    with writing_into(folder, ELSEWHERE_OUT):
        path = write_modes(elements, shapes, folder)
        figure = path.with_suffix(".svg")
        write_atomically(figure, svg_of(drawn))
    rows = elastic_mode_table(shapes)
    if as_json:
        document = {"case": loaded.name, "modes": rows, "file": str(path), "figure": str(figure)}
        say(json.dumps(document, indent=2))
        return
    bodies = "boxes, of equal boxes once" if loaded.container.is_loose else "container"
    say(f"{loaded.name}: elastic modes of the free {bodies}\n")
    say("  mode   frequency [Hz]   period [ms]   to the first")
    for row in rows:
        say(
            f"  {row['mode']:4.0f}   {row['frequency_Hz']:14.3f}   {1e3 * row['period_s']:11.4f}   "
            f"{row['ratio_to_first']:12.3f}"
        )
    say(f"\n{figure} shows the shapes, {path} in ParaView (Warp By Vector)")
