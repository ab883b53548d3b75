"""The catalogue of faults keeps up with the code: each has its place, and tests that exist."""

import ast

import pytest
from mutation import ROOT, SOURCES
from mutations import MUTATIONS


def test_there_are_enough_of_them_and_no_two_alike():
    assert len(MUTATIONS) >= 15
    assert len({m.old for m in MUTATIONS}) == len(MUTATIONS)
    assert {m.file.split("/")[0] for m in MUTATIONS} == {"fem", "mesh", "contact", "tests"}


@pytest.mark.parametrize("mutation", MUTATIONS, ids=lambda mutation: mutation.name)
def test_a_fault_stands_once_in_the_sources_and_leaves_code(mutation):
    text = SOURCES[mutation.file]
    broken = text.replace(mutation.old, mutation.new)
    assert ast.dump(ast.parse(broken)) != ast.dump(ast.parse(text))


@pytest.mark.parametrize("mutation", MUTATIONS, ids=lambda mutation: mutation.name)
def test_its_tests_exist(mutation):
    files = [test for test in mutation.tests if test.endswith(".py")]
    assert files
    assert all((ROOT / "tests" / name).is_file() for name in files)
