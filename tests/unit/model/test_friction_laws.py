"""Every friction law of a case file is known wherever one is asked for; another one is refused."""

from typing import get_args

import pytest

from fem.case.tables import ContactTable
from fem.model.equilibrium import CODES

LAWS = get_args(ContactTable.model_fields["friction"].annotation)


def test_every_law_has_a_code_of_its_own():
    assert set(CODES) == set(LAWS)
    assert len(set(CODES.values())) == len(LAWS)


@pytest.mark.parametrize("law", LAWS)
def test_every_law_sticks_or_creeps(law):
    assert ContactTable.model_construct(friction=law).sticks == (law == "elastic-stick")


def test_a_law_that_nobody_knows_is_refused():
    another = ContactTable.model_construct(friction="viscous")
    with pytest.raises(AssertionError, match="viscous"):
        _ = another.sticks
    with pytest.raises(KeyError, match="viscous"):
        _ = CODES[another.friction]
