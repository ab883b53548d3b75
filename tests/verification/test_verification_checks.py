"""The verification checks pass, each finding with its own tolerance."""

import re
from pathlib import Path

import pytest
from verification.suite import CHECKS

README = Path(__file__).parents[1] / "README.md"
SLOW = {
    "order at large rotation",
    "manufactured solution, dynamic",
    "impact of a bar",
    "full model",
    "full model through an impact",
    "a shell refined",
    "a bed of springs",
    "half-sine pulse",
    "a push on every support",
    "overturning by pulses",
    "elastica",
    "penalties, steps, meshes",
    "a stated restitution under a pulse",
    "a start at rest",
}


@pytest.mark.parametrize(
    "check",
    [pytest.param(check, marks=[pytest.mark.slow] * (check.title in SLOW)) for check in CHECKS],
    ids=lambda check: f"{check.topic}: {check.title}",
)
def test_every_finding_of_a_verification_check_holds(check):
    findings = list(check.findings())
    failed = [one for one in findings if not one.holds]
    assert findings and not [f"{one.name}: {one.value:.6g} for {one.reference:.6g}" for one in failed]


def test_no_check_is_lost_or_called_as_another():
    assert len({check.title for check in CHECKS}) == len(CHECKS) == 93
    assert {check.title for check in CHECKS} >= SLOW


def test_the_readme_of_the_tests_names_every_topic():
    verification = README.read_text(encoding="utf-8").partition("## Where verification is")[2]
    assert {check.topic for check in CHECKS} <= set(re.findall(r"\w+", verification.partition("\n## ")[0]))
