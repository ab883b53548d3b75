"""`size`: the values of one key that fulfil the rule of a site."""

import importlib
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from fem.cli.console import STUDY, AllowOutside, StudyFlags, print_result, whole
from fem.results.kinds import SIZE

if TYPE_CHECKING:
    from fem.site.size import SizeResult


def size(
    site: str,
    /,
    *,
    over: Annotated[
        str, Parameter(help="The key: container.width_m, container.boxes, contact.mu_static, site...")
    ],
    low: Annotated[
        float | None,
        Parameter(name="--from", show_default=False, help="Least value; default: as suits the key."),
    ] = None,
    high: Annotated[float | None, Parameter(name="--to", show_default=False, help="Largest value.")] = None,
    count: Annotated[int | None, whole("Values of the scan; default: 13.")] = None,
    flags: StudyFlags = STUDY,
    allow_outside: AllowOutside = False,
) -> int:
    """Find the least width, the tallest stack, the window of friction or the strongest action that fulfils the rule.

    Parameters
    ----------
    site:
        A site file or the name of a shipped one: site, cologne.
    """
    request = importlib.import_module("fem.site.request").load_site(site)
    axis = importlib.import_module("fem.site.size").size_axis(request, over, low=low, high=high, count=count)
    folder = flags.folder(f"{request.name}_size")
    study = importlib.import_module("fem.site.size_run")
    with flags.options() as options:
        result = study.run_size(request, axis, folder, allow_outside=allow_outside, **options)
    return print_result(result, SIZE, folder, page_of(result, folder), as_json=flags.as_json)


def page_of(result: "SizeResult", folder: Path) -> Iterator[str]:
    """The lines of a size study, for people."""
    keys = " and ".join([result.key, *result.followers])
    yield (
        f"{keys}: {len(result.points)} values from {result.low:g} to {result.high:g} {result.unit}"
    ).rstrip()
    fulfilled = sum(bool(point.fulfilled) for point in result.points)
    yield f"  fulfilled  at {fulfilled} of them, {sum(point.runs for point in result.points)} runs of their sets"
    yield f"  files      {folder}"
