"""What is said of a site for what a line of a transcript makes: `repeated(), further(71)`, `box(still=112)`."""

from collections.abc import Callable, Iterable
from dataclasses import replace
from pathlib import Path

from site_example import ACTION, RUN, example, k1
from small_site import SITE

from fem.case.validation import CaseError
from fem.html.page import Page, html_of, text_of
from fem.seismic.methods import peak_rows
from fem.site import size as sizes
from fem.site.answer import answer_of
from fem.site.methods import found_by_runs
from fem.site.page import shown
from fem.site.request import load_site
from fem.site.result import (
    FURTHER,
    REPEATED,
    ConfirmedRun,
    FloorResult,
    SiteAnswer,
    SizeResult,
    TwoDirections,
)
from fem.site.runs import key_of
from fem.site.size import SizeAxis, next_values, size_axis, spaced
from fem.site.stages import REPETITIONS
from fem.site.tables import LimitsTable

EXAMPLE = example()[0]


def runs(motions=range(1, 8), stage="set", **changes):
    return [replace(RUN, stage=stage, motion=number, **changes) for number in motions]


def first(**changes):
    """The runs of the set, the first of which is changed."""
    return runs((1,), **changes) + runs(range(2, 8))


def repeated(**changes):
    return [run for factor in REPETITIONS for run in runs(stage=REPEATED, factor=factor, **changes)]


def further(count=100, beyond=0, overturned=0, **changes):
    """So many further motions; some slide beyond the clearance, others overturn."""
    found = runs(range(1, count + 1), FURTHER, **changes)
    found[:beyond] = [replace(run, max_slip_m=0.2) for run in found[:beyond]]
    found[count - overturned :] = [replace(run, outcome="overturned") for run in found[count - overturned :]]
    return found


def confirmed(**changes):
    found = {"outcome": "rock", "rotation_ratio": 0.1, "max_slip_m": 0.01} | changes
    return (ConfirmedRun(run=RUN, model="reduced", sure="sure", **found),)


def in_two_directions(largest, factor, **more):
    slips = {"slip_mean_m": 0.5 * largest, "slip_largest_m": largest, "slip_mean_in_plane_m": 0.2 * largest}
    return TwoDirections(mu_static=0.3, mu_kinetic=0.15, motion=5, margin_factor=factor, **slips, **more)


def answer(*stages, **beside):
    request = load_site("site").with_value("limits.slip_m", 0.1)  # and 0.5, 0.8 of the angle
    motions = replace(EXAMPLE.set, count=len({run.motion for run in stages[0]}))
    return answer_of(request, motions, {key_of(run): run for stage in stages for run in stage}, **beside)


def answered(asked):
    """The sentence, the reasons against, and the rule."""
    found = eval(f"answer({asked})")  # a line of this folder
    return "\n".join([f"{found.answer}: {found.sentence}", *found.reasons, f"rule: {found.rule}"])


def changed(floor=None, action=None, run=None, **answer):
    """The example with other findings; a floor by its differences from one in a building of ten storeys."""
    tall = {"z_over_h": 0.5, "building": "10 storeys", "building_periods_s": (2.0,), "damping_ratio": 0.05}
    tall |= {"peak_m_s2": 1.9, "peak_velocity_m_s": 0.5, "mean_m_s2": ()}
    return replace(
        EXAMPLE,
        result=replace(EXAMPLE.result, **answer),
        floor=None if floor is None else FloorResult(**tall | floor),
        action=replace(EXAMPLE.action, **action or {}),
        runs=(*(replace(one, **run or {}) for one in EXAMPLE.runs[:2]), *EXAMPLE.runs[2:]),
    )


def deciding(**changes):
    once = replace(RUN, rotation_ratio=0.47, max_slip_m=0.0052)
    return (replace(EXAMPLE.result.confirmed[0], run=once, **changes),)


def brief_page(asked):
    """The two sheets of the example with changes, and what the command prints."""
    result = eval(f"changed({asked})")
    page = Page(kind="", title="", name="", hash="", signature=None)
    html = html_of(page, "site.html.j2", **shown(result, Path(), brief=True))
    lines = text_of("assess.txt.j2", result=result, folder=Path("out")).splitlines()
    return html + "".join(f"<p>{line}</p>" for line in lines)


#: a value that fulfils the rule, and one that does not
WORDS = {"answer": "fulfilled", "fulfilled": True, "rule": "", "sentence": ""}
STANDS = SiteAnswer(**WORDS, overturned=0, runs=28, rotation_ratio=0.1, slip_m=0.01)
FELL = replace(
    STANDS, answer="not fulfilled", fulfilled=False, overturned=3, rotation_ratio=None, slip_m=None
)


def axis_of(key: str, words: str, unit: str, wanted: str, values: Iterable[float], **more: bool) -> SizeAxis:
    return SizeAxis(key=key, words=words, unit=unit, wanted=wanted, values=tuple(values), **more)


WIDTH = axis_of("container.width_m", "width", "m", "least", spaced(0.8, 2.0, 13))
AG = "site.reference_acceleration_m_s2"
STRENGTH = axis_of(AG, "reference acceleration", "m/s2", "largest", spaced(0.2, 6.0, 15))
FRICTION = axis_of("contact.mu_static", "static friction", "", "window", spaced(0.1, 0.8, 15))
BOXES = axis_of("container.boxes", "number of boxes", "", "largest", map(float, range(1, 7)), whole=True)


def size_result(axis: SizeAxis, answers: dict[float, SiteAnswer]) -> SizeResult:
    """The result for the answers at some values of an axis."""
    begun = SizeResult(key=axis.key, unit=axis.unit, low=axis.values[0], high=axis.values[-1])
    return sizes.size_result(axis, answers, begun)


def size(axis: SizeAxis, fulfils: Callable[[float], bool]) -> SizeResult:
    """The result where `fulfils(value)` says which values do; every value is asked for once."""
    found: dict[float, SiteAnswer] = {}
    while values := next_values(axis, found):
        assert not set(values) & set(found)
        found |= {value: STANDS if fulfils(value) else FELL for value in values}
    return size_result(axis, found)


def ends(**changes):
    """Stacks of one box that stand; of six another answer."""
    return size_result(BOXES, {1.0: STANDS, 6.0: replace(FELL, **changes)})


def site(*changes):
    """A site file with texts replaced, one after the other."""
    text = SITE
    for old, new in zip(changes[::2], changes[1::2], strict=True):
        assert old in text, old
        text = text.replace(old, new)
    Path("hall.toml").write_text(text, encoding="utf-8")
    return load_site("hall.toml")


def axis(key, *changes, **ends):
    return size_axis(site(*changes) if changes else load_site("site"), key, **ends)


def requested(request):
    """What is asked for: variants, frictions, motions, wind, action, and for what nobody stands."""
    variants = [
        f"{' '.join(name)}: {case.container.width_m:g} m wide, {case.mass:.6g} kg, {case.container.boxes} boxes"
        for name, case in request.variants.items()
    ]
    motions, action = request.motions, request.action
    return "\n".join(
        [
            *variants,
            f"friction: {', '.join(f'{static:g} / {kinetic:g}' for static, kinetic in request.frictions)}",
            f"motions: {motions.source}, {motions.files}, {'with' if motions.vertical else 'no'} vertical ones",
            f"wind: {request.wind_pressure}",
            f"action: {action.surface_acceleration:.6g}, upward {action.vertical_acceleration:.6g} m/s2",
            f"nobody stands for: {', '.join(request.unstated)}",
        ]
    )


STOOD = replace(RUN, mu_static=0.2, mu_kinetic=0.1, rotation_ratio=0.2, max_slip_m=0.004)
FELLED = replace(STOOD, motion=2, outcome="overturned", rotation_ratio=3.0)
OVERTURNING, SLIDING = peak_rows(k1(mu_static=0.2), ACTION, horizontal=1.0, vertical=0.0)
STRONGER = peak_rows(k1(mu_static=0.2), ACTION.scaled(1.5), horizontal=1.0, vertical=0.0)[0]


def beside(row, *runs):
    """What the rule counts beside a method; its limits are 0.5, 0.8 of the angle and 0.1 m."""
    words, compared = found_by_runs(row, runs, width=1.1, limits=LimitsTable(slip_m=0.1))
    return f"{words}: {compared or 'not compared'}"


def sited(asked):
    """What is found of a site, the sentence of `size`, or why a site file or a key of it is refused."""
    try:
        found = eval(asked)
        return found if isinstance(found, str) else getattr(found, "sentence", "nothing is said against it")
    except CaseError as error:
        return str(error)
