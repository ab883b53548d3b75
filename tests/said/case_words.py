"""What a case holds, or why it is refused, for what a line of a transcript asks of it.

A line has a named case and changes as `--set` takes them: ` & ` between changes made at once, ` then ` between those
made one after the other. `written`: the resolved case; `changed`: what differs from the case named; `ranges`: its
unknown inputs with their ends, and in brackets what is tried between; `boxes`: what stands there; `drawn`: its sketch;
`sheet`: its static calculation.
"""

import difflib
import re
from functools import reduce

from cases import named_case

from fem.case.case import Case, CaseError, case_hash, read_case, to_toml
from fem.case.overrides import parse_override
from fem.case.tables.unknown_inputs import ranges_of
from fem.case.template import case_template
from fem.case.uncertainty import as_changed
from fem.model.floor_numbers import drawn_level
from fem.model.geometry import build_container
from fem.model.motion import build_motions, peaks_in_run
from fem.model.static_checks import static_checks_of
from fem.report.sketch import sketch
from fem.report.static_sheet import static_sheet

PENALTY = 1e9  #: of a contact whose stiffness is chosen [Pa/m]


def cased(asked: str) -> str:
    """What a line asks of a case; of one that is refused the reason."""
    verb, _, rest = asked.partition(" ")
    name, *changes = [part.strip() for part in rest.replace(" then ", " | ").split(" | ")]
    own = named_case(name)
    try:
        return SAID[verb](own, reduce(changed, changes, own))
    except CaseError as error:
        return str(error)


def changed(case: Case, changes: str) -> Case:
    """Changes made at once; after `as` those of a member of a band, with what follows from them."""
    member, text = changes.startswith("as "), changes.removeprefix("as ")
    values = dict(map(parse_override, text.split(" & ")))
    return case.with_values(as_changed(case, values) if member else values)


def difference(own: Case, case: Case) -> str:
    """Lines of the resolved case; its file and its template read back to it."""
    for again in map(read_case, (to_toml(case), case_template(case))):
        assert (again.resolved(), case_hash(again)) == (case.resolved(), case_hash(case))
    lines = difflib.unified_diff(to_toml(own).splitlines(), to_toml(case).splitlines(), n=0, lineterm="")
    same = "the same case\n" if case_hash(own) == case_hash(case) else ""
    return same + "\n".join(line for line in lines if line[:2] not in ("--", "++", "@@"))


def ranges(_: Case, case: Case) -> str:
    """A line for each unknown input, of the case as it is written."""
    return "\n".join(
        f"{one.key}: {', '.join(map(shown, one.ends))}"
        + (f" ({', '.join(map(shown, one.between))})" if one.between else "")
        for one in ranges_of(read_case(to_toml(case)), PENALTY)
    )


def shown(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def boxes(_: Case, case: Case) -> str:
    """Each box from the floor up, and the friction between them."""
    lines = [
        f"{box.width:g} x {box.height:g} m, {box.mass:.6g} kg, centroid {box.centroid:g} m, axis {box.axis:g} m, "
        f"from {box.bottom:g} m, wall {box.wall}"
        for box in case.stack
    ]
    lines.append(f"{case.mass:.6g} kg, {case.weight:.6g} N, {case.container.total_height:g} m high")
    return "\n".join([*lines, f"between them {case.joint_friction}"])


def drawn(_: Case, case: Case) -> str:
    """The texts of the sketch of a case, and its name; the rows beside it are in `pages.txt`."""
    svg = str(sketch(case, centroid=1.3, peak_acceleration=2.4))
    name = re.search(r'aria-label="([^"]*)"', svg)
    texts = re.findall(r">([^<>]+)</text>", svg)
    return "\n".join([name[1] if name else "", " | ".join(texts), drawn_level(case.floor.slope_percent)])


def sheet(_: Case, case: Case) -> str:
    """Each line of the static calculation."""
    static = static_checks_of(case, build_container(case), *peaks_in_run(case, *build_motions(case)))
    lines = []
    for title, group in static_sheet(static, case):
        rows = (f"  {one.name}: {one.numbers} = {one.result} {one.verdict or ''}" for one in group)
        lines += [title, *rows]
    return "\n".join(lines)


SAID = {
    "drawn": drawn,
    "sheet": sheet,
    "written": lambda own, case: to_toml(case),
    "changed": difference,
    "ranges": ranges,
    "boxes": boxes,
    "motion": lambda own, case: (
        f"{case.motion.amplitude:.6g} m, {case.motion.angular_frequency:.6g} rad/s, {case.motion.nominal_peak} m/s2"
    ),
}
