"""Every friction law of a case file is known wherever one is asked for; another one is refused."""

from typing import get_args

import pytest

from contact.interface.laws import FRICTION_LAWS
from fem.case.tables.contact_tables import ContactTable

LAWS = get_args(ContactTable.model_fields["friction"].annotation)
CONTACT = ContactTable(mu_static=0.4, mu_kinetic=0.4, damping_ratio=2.0)


def test_every_law_has_a_code_of_its_own():
    assert set(FRICTION_LAWS) == set(LAWS)
    assert len(set(FRICTION_LAWS.values())) == len(LAWS)


@pytest.mark.parametrize("law", LAWS)
def test_every_law_sticks_or_creeps(law):
    assert CONTACT.model_copy(update={"friction": law}).sticks == (law == "elastic-stick")


def test_a_law_that_nobody_knows_is_refused():
    another = CONTACT.model_copy(update={"friction": "viscous"})
    with pytest.raises(AssertionError, match="viscous"):
        _ = another.sticks
    with pytest.raises(KeyError, match="viscous"):
        _ = FRICTION_LAWS[another.friction]
