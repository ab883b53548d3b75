"""Settings of the whole suite."""

import os

import pytest
from hypothesis import settings

# A slow or busy machine must not fail a property; on a server every run tries the same examples.
settings.register_profile("suite", deadline=None, derandomize=bool(os.environ.get("CI")), print_blob=True)
settings.load_profile("suite")


@pytest.fixture
def undrawn(monkeypatch):
    """Maps take four fifths of the time of so small a sweep, and are tested by themselves."""
    monkeypatch.setattr("fem.sweep.run.draw_maps", lambda table, folder, choice: [])
