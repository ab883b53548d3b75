"""The verification checks pass: every quick one, each row with its own tolerance."""

import pytest

from fem.verification.suite import CHECKS

QUICK = [check for check in CHECKS if check.quick]


@pytest.mark.parametrize("check", QUICK, ids=lambda check: f"{check.topic}: {check.title}")
def test_every_row_of_a_verification_check_passes(check):
    rows = list(check.rows())
    assert rows
    failed = [
        f"{row.case}: {row.compared}: {row.value:.6g} for {row.reference:.6g}"
        for row in rows
        if not row.passed
    ]
    assert not failed


def test_the_suite_is_complete():
    topics = {
        "statics": 2,
        "elasticity": 9,
        "time": 9,
        "contact": 7,
        "sliding": 10,
        "rocking": 6,
        "restitution": 4,
        "overturning": 5,
        "limits": 8,
    }
    found = [check.topic for check in CHECKS]
    assert {topic: found.count(topic) for topic in dict.fromkeys(found)} == topics
    assert list(dict.fromkeys(found)) == list(topics)
    assert len({check.title for check in CHECKS}) == len(CHECKS) == 60
    assert [check.title for check in CHECKS if not check.quick] == [
        "manufactured solution, dynamic",
        "impact of a bar",
        "full model",
    ]
