"""How sure the cells of a sweep are: which copies they have, what these say, and what a sweep holds fixed."""

import csv

import numpy as np
import pytest
from small_sweep import SMALL

from fem.case.case import load_case
from fem.model.model import build_model
from fem.run.changed_runs import key_of
from fem.run.compute import compute
from fem.run.simulation import run_without_history
from fem.study.axes import Axis
from fem.study.draws import held_inputs
from fem.study.file import load_sweep
from fem.study.sure import Copies, around, coarse_cells, left_out
from fem.study.sweep import run_sweep
from fem.study.sweep_table import open_sweep

pytestmark = pytest.mark.usefixtures("undrawn")


@pytest.fixture
def sweep_of(tmp_path):
    def read(text):
        path = tmp_path / "small.toml"
        path.write_text(text, encoding="utf-8")
        return load_sweep(path)

    return read


def copies_of(sweep, cell=0):
    return Copies(sweep, {}).of(cell)


def keys_of(sweep, cell=0):
    """The keys that the copies of a cell change, those of draws together."""
    return {key for copy in copies_of(sweep, cell) for key in copy.change.values}


def test_a_copy_of_a_cell_is_the_member_of_the_band_of_its_run(sweep_of):
    # Kinetic friction follows the static one, and step and penalty are those chosen for the cell.
    given = '"contact.mu_kinetic" = 0.4\n"contact.mu_static" = 0.4\n[axes]'
    sweep = sweep_of(SMALL.split("[derived]")[0].replace("[axes]", given))
    band = compute(sweep.case(0), band=True, margin=False).verdict.band
    members = {key_of(one.values): one for one in band.members if one.kind == "one"}
    found = {}
    for copy in copies_of(sweep):
        if key_of(copy.change.values) in members:
            model = build_model(sweep.make.case(sweep.item(0)._replace(more=copy.values)))
            found[key_of(copy.change.values)] = run_without_history(model, None)[0]
    assert {"contact.mu_static", "container.eccentricity_m"} <= {key for some in found for key, _ in some}
    for key, verdict in found.items():
        assert (verdict.outcome, verdict.rotation_ratio) == (
            members[key].outcome,
            members[key].rotation_ratio,
        )


@pytest.mark.parametrize(
    ("table", "gone"),
    [
        ('"uncertainty.slope_percent" = "held"', {"floor.slope_percent"}),
        ('"uncertainty.damping_ratio" = "known"', {"contact.damping_ratio"}),
        ('"uncertainty.normal_penalty_Pa_m" = "known"', {"contact.normal_penalty_Pa_m"}),
    ],
)
def test_a_known_input_is_left_out(sweep_of, table, gone):
    text = SMALL.replace("[axes]", f"{table}\n[axes]")
    assert keys_of(sweep_of(SMALL)) - keys_of(sweep_of(text)) == gone


def test_a_deformable_container_leaves_out_what_takes_long(sweep_of):
    sweep = sweep_of(SMALL.replace('model" = "rigid"', 'model" = "reduced"'))
    copies = copies_of(sweep)
    assert {copy.change.kind for copy in copies} == {"one"}
    assert "container.damping_ratio" in {key for copy in copies for key in copy.change.values}
    assert "draws" in left_out(sweep)
    assert left_out(sweep_of(SMALL)) == "contact of the base"
    assert "away from a change" in left_out(sweep_of(SMALL + '[perturbation]\ncells = "near"\n'))


def test_the_coarse_grid_leaves_no_cell_far_away():
    axes = [Axis(key=name, values=tuple(map(float, range(count)))) for name, count in (("a", 43), ("b", 46))]
    assert around(axes, coarse_cells(axes), 3).all()
    assert coarse_cells(axes).sum() == 11 * 12
    words = Axis(key="c", values=("rest", "moving"))
    assert coarse_cells([words, axes[0]]).sum() == 2 * 11


def test_a_cell_is_as_sure_as_its_copies_are_and_what_decides_it_turns_it(sweep_of, tmp_path):
    sweep = sweep_of(SMALL + '[perturbation]\ncells = "all"\n')
    info = run_sweep(sweep, tmp_path / "out")
    table = open_sweep(tmp_path / "out")
    with (tmp_path / "out" / "members.csv").open() as stream:
        members = list(csv.DictReader(stream))
    for cell in range(sweep.count):
        own = str(table["outcome"][cell])
        copies = [row for row in members if int(row["cell"]) == cell]
        found = {row["outcome"] for row in copies}
        fell = {one == "overturned" for one in (found | {own})}
        expected = "unsure" if len(fell) > 1 else "sure" if found <= {own} else "regime unsure"
        assert table["sure"][cell] == expected
        decided = table["decided_by"][cell].split()
        assert bool(decided) == (expected != "sure")
        if expected == "unsure":
            turned = [
                row["change"] for row in copies if (row["outcome"] == "overturned") != (own == "overturned")
            ]
            assert all(f"{key}=" in " ".join(turned) for key in decided)
    assert np.array_equal(table["sure"] == "unsure", table["unsure"] == 1.0)
    assert sum(info["sure"].values()) == sweep.count
    assert info["sure"]["unsure"] == info["unsure"] > 0


@pytest.mark.parametrize(
    ("changes", "varied", "words"),
    [
        ("", (), "with mu_k = mu_s/2 falling at once, no ramp"),
        ("contact.weakening_m=0.001", ("motion.start",), "with mu_k = mu_s/2 falling over 1 mm, no ramp"),
        ("contact.mu_kinetic=0.4", ("motion.ramp_cycles",), "with mu_k = mu_s"),
        ("motion.kind=pulse motion.shape=sine motion.pulse_s=1.0", ("contact.mu_kinetic",), "falling"),
    ],
)
def test_what_is_held_is_said(changes, varied, words):
    held = held_inputs([load_case("seed_stack_plateau", changes.split())], varied)
    assert words in held
