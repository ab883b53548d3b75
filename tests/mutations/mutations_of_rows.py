"""Faults in rows of containers."""

from mutation import Mutation

ROWS = "verification/closed_forms/test_rows.py"

ROW_FAULTS = (
    Mutation(
        name="sides whose frames are not apart",
        old="own = _joint(corner, face, other, apart=along)",
        new="own = _joint(corner, face, other, apart=0.99 * along)",
        tests=(ROWS, "-k", "in_phase"),
    ),
    Mutation(
        name="sides apart in one direction only",
        old='"apart": 2 * [apart, -apart],',
        new='"apart": 4 * [apart],',
        tests=(ROWS, "-k", "in_phase"),
    ),
    Mutation(
        name="dashpot of the sides for one mass",
        old="mass = masses[left] * masses[right] / (masses[left] + masses[right])",
        new="mass = masses[left]",
        tests=(ROWS, "-k", "two_sliders_keep"),
    ),
    Mutation(
        name="work of the floor on the first container of a row alone",
        old="        end = run.joints[run.joints.shape[0] - 1].end\n    for i in range(begin, end):\n        shear",
        new="        end = run.joints[0].end\n    for i in range(begin, end):\n        shear",
        tests=(ROWS, "-k", "ledger"),
    ),
    Mutation(
        name="sides without friction",
        old="dashpot_of(neighbour, mass), neighbour.mu))",
        new="dashpot_of(neighbour, mass), 0.0))",
        tests=(ROWS, "-k", "drags"),
    ),
    Mutation(
        name="what neighbours push is not taken from what holds a container",
        old="stands, first, last, load_from_beside(run, j)",
        new="stands, first, last, pushed",
        tests=(ROWS, "-k", "friction_holds"),
    ),
    Mutation(
        name="leaning is standing",
        old="return bool(abs(rotation_of(run, j)) <= run.joints[j].angle)",
        new="return True",
        tests=(ROWS, "-k", "leaning"),
    ),
    Mutation(
        name="gaps of a row that are never hit",
        old="        if record.away > apart:\n            record.hits += 1\n        record.away = 0.0\n\n\n@inlined\n",
        new="        record.away = 0.0\n\n\n@inlined\n",
        tests=(ROWS, "-k", "chain"),
    ),
    Mutation(
        name="steps for the first container of a row",
        old="fastest = max(checks.frequency_parameter for checks in (static, *row))",
        new="fastest = static.frequency_parameter",
        tests=(ROWS, "-k", "short_enough"),
    ),
)
