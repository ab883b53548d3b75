"""The code's rows belong to the user: with [static] they name its values, without it they are not there."""

from cases import LEAST

from fem.case.case import read_case
from fem.case.template import case_template


def test_an_empty_table_takes_the_defaults_and_is_kept():
    case = read_case(LEAST + "[static]\n")
    assert case.static is not None and "static" in case.given()
    assert case.with_values({"contact.mu_static": 0.5}).static == case.static
    assert read_case(LEAST).static is None
    assert read_case(LEAST).with_values({"static.soil_factor": 1.0}).static.soil_factor == 1.0


def test_a_template_of_a_case_without_static_has_it_as_a_comment():
    template = case_template(read_case(LEAST))
    assert "\n# [static]  # " in template and "\n# soil_factor = 1.5" in template
    assert read_case(template).static is None
