"""Settings of the whole suite."""

import os
from importlib import import_module

import pytest
from hypothesis import settings

# A slow or busy machine must not fail a property; on a server every run tries the same examples.
settings.register_profile("suite", deadline=None, derandomize=bool(os.environ.get("CI")), print_blob=True)
settings.load_profile("suite")

WHOLE = 1000  #: tests, from which a run is one of the whole suite


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--say", action="store_true", help="write the texts of tests/said as they are said now")


@pytest.hookimpl(tryfirst=True)
def pytest_configure(config: pytest.Config) -> None:
    """Give a file to one worker: what its tests share is then made once."""
    if config.getoption("dist", "no") == "load":
        config.option.dist = "loadfile"


def pytest_collection_finish(session: pytest.Session) -> None:
    """Compile before the tests: each worker would compile the same kernels when it first needs them."""
    if "PYTEST_XDIST_WORKER" in os.environ and len(session.items) > WHOLE:
        import_module("gallery").compile_kernels()  # late: numba takes a second to import


@pytest.fixture(scope="session")
def gallery(tmp_path_factory: pytest.TempPathFactory):
    """Computed runs that many tests read, see `rigs/gallery.py`; the workers of a session share them."""
    place = tmp_path_factory.getbasetemp()
    place = place.parent if "PYTEST_XDIST_WORKER" in os.environ else place
    return import_module("gallery").Gallery(place / "gallery")  # late, as above


@pytest.fixture
def undrawn(monkeypatch):
    """Maps take four fifths of the time of so small a sweep, and are tested by themselves."""
    monkeypatch.setattr("fem.study.sweep.draw_maps", lambda table, folder, choice: [])
