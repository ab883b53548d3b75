"""The verification ladder stands: every check of the quick one, each row with its own tolerance."""

import pytest

from fem.verification.suite import ROOMS, chosen_checks

QUICK = chosen_checks(quick=True)


@pytest.mark.parametrize(("room", "check"), QUICK, ids=[f"{room}: {check.name}" for room, check in QUICK])
def test_every_row_of_the_quick_ladder_holds(room, check):
    rows = check.rows()
    assert rows
    failed = [
        f"{row.case}: {row.compared}: {row.value:.6g} for {row.reference:.6g}"
        for row in rows
        if not row.passed
    ]
    assert not failed


def test_the_ladder_has_the_rooms_that_it_claims():
    assert list(ROOMS) == [
        "statics",
        "elasticity",
        "time",
        "contact",
        "sliding",
        "rocking",
        "restitution",
        "overturning",
        "limits",
    ]
    names = [check.name for checks in ROOMS.values() for check in checks]
    assert len(set(names)) == len(names)
