"""What can be said of a site before any run: action, motions, what they move, and what a verification would take."""

import json
import math
from dataclasses import dataclass
from pathlib import Path

from fem.html.page import text_of
from fem.results.json_block import JsonBlock
from fem.run.expected import expected_s, of_its_band_s
from fem.runtime.progress import clock_time
from fem.runtime.threads import cores
from fem.site.motions import GIVEN_FLOORS
from fem.site.request import SiteRequest
from fem.site.runs import CONFIRMING, MOST_DECIDING, still
from fem.site.stages import Stages

OF_A_MOTION_S = 0.03  #: processor time of making an artificial motion of three components (`bench.py`)


@dataclass(frozen=True, kw_only=True)
class Forecast(JsonBlock):
    """How many runs a verification takes, and how long."""

    of_set: int
    of_set_still: int  #: of these, below uplift and slip of a rigid body: not computed
    most: int  #: of all stages, without the deciding runs
    seconds: float  #: of them and of making further motions, on these cores, roughly
    deciding_seconds: float  #: of the deciding runs, likewise; 0 where there are none
    cores: int
    quick: bool = False

    def words(self, load: float = 1.0) -> str:
        """In one sentence; `load`: wall time over processor time, where other work shares the cores."""
        return text_of("forecast.txt.j2", one=self, load=load, time=_rounded)


def _rounded(seconds: float) -> str:
    """A time of which one figure is known, rounded up."""
    figure = 10.0 ** math.floor(math.log10(max(seconds, 1.0)))
    return clock_time(figure * math.ceil(seconds / figure - 1e-9))


def forecast(stages: Stages, jobs: int, *, scan: bool = True) -> Forecast:
    """How many runs there will be, before the first is computed; `scan` as of `Stages.most_runs`."""
    own, most = stages.most_runs(scan=scan)
    request = stages.request
    case = still(next(iter(request.variants.values())), request.heading.model)
    deciding = expected_s(still(case, CONFIRMING), record=True)
    total = len(stages.of_set())
    moves = own > 0 and not stages.quick
    made = request.motions.further if moves or not own else 0
    return Forecast(
        of_set=total,
        of_set_still=total - own,
        most=most,
        seconds=(most * expected_s(case, record=True) + made * OF_A_MOTION_S) / jobs,
        deciding_seconds=MOST_DECIDING * of_its_band_s(deciding) / jobs if moves else 0.0,
        cores=jobs,
        quick=stages.quick,
    )


def preview_of(request: SiteRequest, *, allow_outside: bool = False, as_json: bool = False) -> str:
    """What is known of a request, in words or as JSON; nothing is computed but its motions.

    Raises:
        CaseError, MeshError: it cannot be computed.
    """
    stages = Stages.of(request, Path(), allow_outside=allow_outside)
    expected = forecast(stages, cores())
    known = {
        "site": request.name,
        "title": request.heading.title,
        "spectrum": request.action.shape.source,
        "ag_S_m_s2": request.action.surface_acceleration,
        "avg_m_s2": request.action.vertical_acceleration,
        "bodies": [body.to_json() for body in stages.bodies],
        # what it is given by; None: the site moves it, perhaps through a building
        "floor": GIVEN_FLOORS[request.motions.source == "floor"] if request.on_given_floor else None,
        "motions": len(stages.ground),
        "set_valid": stages.checked.valid,
        "reasons": stages.checked.reasons,
        # what the processing of the records changed
        "notes": list(dict.fromkeys(note for motion in stages.ground for note in motion.notes)),
        # on the motions, of a rigid body; None: not known
        "factor_at_first_movement": stages.first_movement,
        "wind_utilisation": stages.wind,
        "forecast": expected.to_json() if as_json else expected,
    }
    if as_json:
        return json.dumps(known, indent=2)
    return text_of("preview.txt.j2", preview=known, request=request)
