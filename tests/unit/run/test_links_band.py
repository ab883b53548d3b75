"""The band of runs with stops, ties and neighbours: what it varies of them, and how it names what decides."""

import fem
from fem.case.case import Case, load_case
from fem.case.tables.input_ranges import UnknownChoice
from fem.case.tables.unknown_inputs import UNKNOWN
from fem.run.card import line

BESIDE = {"side": "right", "gap_m": 0.03, "stiffness_N_m": 1e8, "mu": 0.2}
KERBS = [
    {"side": side, "height_m": 0.1, "gap_m": gap, "stiffness_N_m": 1e8, "mu": 0.3}
    for side, gap in (("left", 0.025), ("right", 0.02))
]
TIES = [
    {"from": "left", "height_m": 0.5, "slack_m": 0.01, "stiffness_N_m": 1e6},
    {"from": "right", "height_m": 2.0, "slack_m": 0.02, "stiffness_N_m": 2e6},
]
LINKS = {
    *("stop_gap_m", "stop_stiffness_N_m", "stop_mu", "tie_slack_m", "tie_stiffness_N_m"),
    *("neighbour_gap_m", "neighbour_stiffness_N_m", "neighbour_mu"),
}
#: slides, and overturns where a narrow kerb stops it
SLIDING = {
    "solver.model": "rigid",
    "solver.duration_s": 4.0,
    "contact.mu_static": 0.25,
    "contact.mu_kinetic": 0.2,
    "motion.peak_acceleration_m_s2": 5.0,
    "motion.frequency_Hz": 0.9,
    "output.fields_s": 0.0,
}


def unsure_of(*names: str, **keys) -> Case:
    """A case in which these inputs alone have a range."""
    held = {
        f"uncertainty.{one.name}": False if isinstance(one, UnknownChoice) else "held"
        for one in UNKNOWN
        if one.name not in names
    }
    return load_case("stack_on_concrete", []).with_values(SLIDING | held | keys)


def test_every_input_of_links_is_varied_alone_and_with_the_others():
    case = unsure_of(*LINKS, stop=KERBS, tie=TIES, neighbour=[BESIDE]).with_values(
        {"solver.duration_s": 0.5, "uncertainty.draws": 4}
    )
    band = fem.compute(case, band=True, margin=False).verdict.band
    keys = {name.replace("_", ".", 1) for name in LINKS}
    alone = {key: set() for key in keys}
    for member in band.members[1:]:
        if member.kind == "one" and (key := next(iter(member.values))) in keys:
            alone[key].add(member.values[key])
        if member.kind == "draw":
            assert set(member.values) == keys
    assert alone["stop.gap_m"] == {0.02, 0.03} and alone["neighbour.gap_m"] == {0.024, 0.036}
    assert alone["stop.mu"] == {0.15, 0.6} and alone["neighbour.mu"] == {0.1, 0.4}
    assert alone["tie.slack_m"] == {0.016, 0.024} and alone["tie.stiffness_N_m"] == {1e6, 4e6}
    assert alone["stop.stiffness_N_m"] == alone["neighbour.stiffness_N_m"] == {5e7, 2e8}


def test_a_gap_that_decides_is_named_and_one_that_is_known_is_not_varied():
    wide = unsure_of("stop_gap_m", stop=KERBS, **{"uncertainty.stop_gap_m": [0.0, 0.2]})
    found = fem.compute(wide, band=True, margin=False)
    said = line(found.typed_result, "sureness")
    assert (found.verdict.outcome, found.verdict.sure) == ("overturned", "unsure")
    assert "gap of the stops 0.2 m" in said
    known = fem.compute(unsure_of(stop=KERBS), band=True, margin=False)
    assert known.verdict.sure == "sure"
    assert {key for one in known.verdict.band.members[1:] for key in one.values} == {
        "solver.energy_tolerance"
    }
