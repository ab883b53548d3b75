"""An ensemble from its file to its folder: seeded, the same on any number of cores, and refused."""

import numpy as np
import pytest
from small_sweep import rows_of

from fem.case.files import ENSEMBLES
from fem.case.tables.unknown_inputs import ranges_of
from fem.results.outcome import Ending
from fem.study.design import Ensemble
from fem.study.draws import draw_shares, read_random
from fem.study.ensemble import run_ensemble
from fem.study.file import load_ensemble
from fem.study.fragility import count_point

FILE = """
case = "seed_stack_plateau"
draws = 8
confidence = 0.9
probability = 0.5
seed = 4
[set]
"solver.model" = "rigid"
"floor.kind" = "rigid"
"solver.duration_s" = 3.0
"solver.energy_tolerance" = 10.0
"motion.frequency_Hz" = 0.5
[axes]
"motion.peak_acceleration_m_s2" = [2.0, 6.0, 12.0]
[random]
"motion.phase_rad" = { distribution = "uniform", from = 0.0, to = 6.2 }
"contact.mu_static" = { distribution = "lognormal", median = 1.0, deviation = 0.1, relative = true }
"free.ratio" = { distribution = "uniform", from = 0.6, to = 1.0 }
[derived]
"contact.mu_kinetic" = "free.ratio * contact.mu_static"
"""


def changed(tmp_path, *pairs):
    """The file, with words replaced."""
    text = FILE
    for before, after in pairs:
        assert before in text, before
        text = text.replace(before, after)
    path = tmp_path / "e.toml"
    path.write_text(text)
    return path


def test_the_same_seed_gives_the_same_files_on_any_number_of_cores(tmp_path):
    ensemble = load_ensemble(changed(tmp_path))
    one = run_ensemble(ensemble, folder=tmp_path / "one", jobs=1)
    assert one["status"] == "completed"
    assert [point["region"] for point in one["points"]] == ["below", "above", "above"]
    run_ensemble(ensemble, folder=tmp_path / "two", jobs=2)
    for name in ("ensemble.json", "points.csv", "draws.csv", "figures/fragility.svg"):
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()
    rows = rows_of(tmp_path / "one" / "draws.csv")
    assert len(rows) == 24
    for k, point in enumerate(one["points"]):
        found = [row["outcome"] for row in rows[8 * k : 8 * k + 8]]
        assert found.count("overturned") == point["overturned"]


def test_unknown_inputs_are_drawn_beside_those_of_the_file(tmp_path):
    drawn = load_ensemble(changed(tmp_path))
    # drawn, derived, not drawn of a stack
    given = {"contact.mu_static", "contact.mu_kinetic", "support.kind"}
    assert set(drawn.unknown) == {one.key for one in ranges_of(drawn.base, 1e9)} - given
    assert drawn.held == ""
    held = load_ensemble(changed(tmp_path, ("seed = 4\n", 'seed = 4\nunknown_inputs = "held"\n')))
    draws = drawn.draws_at(1)
    assert [draw.drawn for draw in draws] == [draw.drawn for draw in held.draws_at(1)]
    assert {draw.unknown["motion.ramp_cycles"] for draw in draws} == {0.0, 0.74999999925}
    for draw in draws:
        case = drawn.make.case(draw)
        assert case.motion.ramp_cycles == draw.unknown["motion.ramp_cycles"]
        assert 0.0 <= case.contact.weakening_m <= 5e-3
        assert 1.0 <= case.contact.damping_ratio <= 4.0
    assert held.unknown == ()
    assert held.held == "with friction falling at once, no ramp"
    assert not any(draw.unknown for draw in held.draws_at(1))


@pytest.mark.parametrize("sampling", ["latin-hypercube", "sobol"])
def test_unknown_inputs_do_not_follow_the_others(sampling):
    """Over many replicates, the first column of the one stream and of the other are independent."""
    given = {"seed": 1, "cell": 0, "draws": 4096, "replicates": 512, "dimensions": 2}
    one, other = draw_shares(sampling, **given), draw_shares(sampling, **given, stream=1)
    assert abs(np.corrcoef(one[:, 0], other[:, 0])[0, 1]) < 4.0 / np.sqrt(4096)
    both = np.mean((one[:, 0] < 0.5) & (other[:, 0] < 0.5))
    assert both == pytest.approx(0.25, abs=4.0 * np.sqrt(0.25 * 0.75 / 4096))


@pytest.mark.parametrize(
    ("given", "middle", "ends"),
    [
        ({"distribution": "uniform", "from": 1, "to": 3}, 2.0, (1.0, 3.0)),
        ({"distribution": "log-uniform", "from": 0.5, "to": 2}, 1.0, (0.5, 2.0)),
        ({"distribution": "normal", "mean": 1.0, "deviation": 0.1, "cut": 2}, 1.0, (0.8, 1.2)),
        ({"distribution": "lognormal", "median": 1, "deviation": 0.5}, 1.0, (np.exp(-1.5), np.exp(1.5))),
    ],
)
def test_distributions_have_their_middles_and_ends(given, middle, ends):
    one = read_random("contact.mu_static", given)
    assert one.values(np.array([0.5]))[0] == pytest.approx(middle)
    assert one.ends == pytest.approx(ends)


def test_a_normal_quantity_has_its_deviation():
    one = read_random("x", {"distribution": "normal", "mean": 1.0, "deviation": 0.1})
    values = one.values((np.arange(20000) + 0.5) / 20000)
    # Cut at three deviations, a normal quantity keeps 0.9866 of its deviation.
    assert np.std(values) == pytest.approx(0.09866, rel=1e-3)


def test_a_point_with_failed_draws_is_judged_with_them_against_it(tmp_path):
    ensemble = load_ensemble(changed(tmp_path))
    codes = np.array([Ending.STANDING] * 5 + [Ending.FAILED] * 3)
    point = count_point(ensemble, 0, codes)
    assert point["probability"] == 0.0 and point["failed"] == 3
    assert point["high"] > 0.5 and point["region"] == "undecided"
    assert count_point(ensemble, 0, np.array([Ending.STANDING] * 8))["region"] == "below"


@pytest.mark.parametrize("name", ENSEMBLES.names)
def test_shipped_ensembles_can_be_read(name):
    ensemble = load_ensemble(name)
    assert isinstance(ensemble, Ensemble)
    case = ensemble.make.case(ensemble.draws_at(0)[0])
    assert case.contact.mu_kinetic < case.contact.mu_static


def test_a_draw_that_slides_beyond_the_limit_does_not_stand(tmp_path):
    free = run_ensemble(load_ensemble(changed(tmp_path)), folder=tmp_path / "free", jobs=1)
    limit = 0.5 * max(point["max_slip_m"] or 0.0 for point in free["points"])
    assert limit > 0.0
    limited = load_ensemble(changed(tmp_path, ("seed = 4", f"seed = 4\nlimit_slip_m = {limit!r}")))
    found = run_ensemble(limited, folder=tmp_path / "limited", jobs=1)
    pairs = zip(free["points"], found["points"], strict=True)
    fallen = [(one["overturned"], other["overturned"]) for one, other in pairs]
    assert all(less <= more for less, more in fallen) and any(less < more for less, more in fallen)
    assert all((point["max_slip_m"] or 0.0) <= limit for point in found["points"])


def test_two_axes_make_a_boundary(tmp_path):
    path = changed(
        tmp_path,
        ("[2.0, 6.0, 12.0]", '[2.0, 12.0]\n"free.slenderness" = [2.0, 4.0]'),
        ("[derived]", '[derived]\n"container.width_m" = "4.0 / free.slenderness"'),
        ('solver.duration_s" = 3.0', 'solver.duration_s" = 1.5'),
    )
    done = run_ensemble(load_ensemble(path), folder=tmp_path / "b")
    assert done["status"] == "completed" and len(done["points"]) == 4
    assert done["fragility"] is None
    words = {"below": "at most 0.5", "undecided": "not decided by the draws", "above": "more than 0.5"}
    drawn = (tmp_path / "b" / "figures" / "boundary.svg").read_text()
    regions = {point["region"] for point in done["points"]}
    assert [word in drawn for word in words.values()] == [region in regions for region in words]
