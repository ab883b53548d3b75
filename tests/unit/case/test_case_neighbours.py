"""[[neighbour]] of a case file: reading, refusing, changing and writing it, and the cases of a row."""

import pytest

from fem.case.case import CaseError, case_hash, load_case
from fem.case.tables.neighbours import places_of
from fem.case.tables.unknown_inputs import ranges_of
from fem.cli.check import preview_of
from fem.model.container import discretise
from fem.model.model import build_model
from fem.study.containers import container_key
from mesh.errors import MeshError

BESIDE = {"side": "right", "gap_m": 0.05, "stiffness_N_m": 1e8}
RIGID = load_case("rocking", ["solver.model=rigid"])


def test_a_neighbour_is_the_container_but_for_what_is_given():
    keys = {"width_m": 2.0, "boxes": 2, "mass_kg": 3000.0}
    pushed = RIGID.with_values({"initial.velocity_m_s": 0.5})
    own, equal, other = pushed.with_values({"neighbour": [BESIDE, {**BESIDE, **keys}]}).row
    assert case_hash(own) == case_hash(pushed)
    assert equal.container == own.container
    assert (other.container.width_m, other.mass) == (2.0, 6000.0)
    assert (own.container.eccentricity_m, other.container.eccentricity_m) == (0.0, 0.0)
    aside = pushed.with_values(
        {"container.eccentricity_m": 0.011, "neighbour": [{**BESIDE, "width_m": 2.2}, BESIDE]}
    )
    shares = [one.container.eccentricity_m / one.container.width_m for one in aside.row]
    assert shares == pytest.approx([0.011 / pushed.container.width_m] * 3)
    assert other.container.height_m == own.container.height_m
    assert not equal.initial.is_pushed
    assert own.initial.is_pushed
    assert RIGID.row == ()


def test_cases_share_a_container_where_all_of_the_row_is_equal():
    row = RIGID.with_values({"neighbour": [BESIDE]})
    keys = [container_key(one) for one in (RIGID, row, row.with_values({"neighbour.gap_m": 0.2}))]
    assert len(set(keys)) == 3
    assert container_key(row.with_values({"contact.mu_static": 0.3})) == keys[1]


def test_neighbours_stand_outward_in_the_order_given():
    rows = [BESIDE, {**BESIDE, "side": "left", "gap_m": 0.1}, {**BESIDE, "gap_m": 0.2}]
    places = places_of(RIGID.with_values({"neighbour": rows}), [1.0, 2.0, 3.0, 4.0])
    assert places.x == pytest.approx((0.0, 1.55, -2.1, 4.75))
    assert places.pairs == ((0, 1), (2, 0), (1, 3))


def test_no_container_of_a_row_gains_at_an_impact_but_by_its_own_case():
    slender, height = {**BESIDE, "width_m": 0.4}, RIGID.container.total_height
    loss = 1.5 / (1.0 + (height / 0.4) ** 2)
    most = (1.0 - 0.3 * loss) / (1.0 - loss)
    ranges = {one.key: one.ends for one in ranges_of(RIGID.with_values({"neighbour": [slender]}), 1e9)}
    assert ranges["contact.restitution_over_housner"][1] == pytest.approx(most)
    stated = RIGID.with_values({"neighbour": [slender], "contact.restitution_over_housner": 1.05})
    for refuse in (build_model, lambda case: preview_of(case).numerics):
        with pytest.raises(CaseError, match="more than there was"):
            refuse(stated)


def test_a_mass_beside_the_axis_needs_two_columns_in_every_container_of_a_row():
    wide = RIGID.with_values(
        {"container.width_m": 4.0, "container.wall_m": None, "solver.element_size_m": 1.0}
    )
    narrow = wide.with_values({"neighbour": [{**BESIDE, "width_m": 0.5}]})
    assert "container.eccentricity_m" in {one.key for one in ranges_of(wide, 1e9)}
    assert "container.eccentricity_m" not in {one.key for one in ranges_of(narrow, 1e9)}
    with pytest.raises(MeshError, match=r"\[\[neighbour\]\] 1, as a container: a box of one column"):
        discretise(narrow.with_values({"container.eccentricity_m": 0.01}))
