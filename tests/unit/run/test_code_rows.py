"""The code's rows belong to the user: with [static] they name its values, without it they are not there."""

import json

import pytest
from cases import LEAST

from fem.__main__ import main
from fem.case.case import load_case, read_case
from fem.case.template import case_template

STATIC = "[static]\nground_acceleration_m_s2 = 0.8\nsoil_factor = 1.2\ncorner_period_s = 0.3\n"
APPLIES_NOT = "does not apply"


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


@pytest.mark.parametrize("given", [True, False])
def test_check_shows_the_codes_rows_where_they_are_given(tmp_path, capsys, given):
    path = tmp_path / "case.toml"
    path.write_text(LEAST + STATIC * given)
    assert main(["check", str(path)]) == 0
    page = capsys.readouterr().out
    assert ("code, q = 1.5" in page) == given
    assert page.count(APPLIES_NOT) == given
    assert main(["check", str(path), "--json"]) == 0
    static = json.loads(capsys.readouterr().out)["static"]
    assert (static["code"] is not None, static["code_q1"] is not None) == (given, given)


@pytest.mark.parametrize("name", ["seed_box", "rocking", "sliding", "overturning", "free_rocking"])
def test_shipped_cases_give_the_values_of_the_paper(name):
    values = load_case(name).static
    assert (values.ground_acceleration_m_s2, values.soil_factor, values.behaviour_factor) == (1.6, 1.5, 1.5)
