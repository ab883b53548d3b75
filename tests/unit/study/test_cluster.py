"""A sweep on a dask cluster: the same table as here; a scheduler that does not answer is reported at once."""

import socket
import time

import pytest
from small_sweep import SMALL, rows_without_wall

from fem.__main__ import main

distributed = pytest.importorskip("distributed", reason="the extra 'cluster' is not installed")
cluster = pytest.importorskip("fem.study.cluster").cluster


@pytest.fixture(scope="module")
def address():
    options = {"n_workers": 1, "threads_per_worker": 2, "processes": False, "dashboard_address": None}
    with distributed.LocalCluster(protocol="tcp", host="127.0.0.1", **options) as local:
        yield local.scheduler_address


@pytest.mark.slow
def test_a_cluster_gives_the_same_table(tmp_path, monkeypatch, capsys, address, undrawn):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "small.toml").write_text(SMALL, encoding="utf-8")
    assert main(["sweep", "small.toml", "-q", "--scheduler", address]) == 0
    assert main(["sweep", "small.toml", "-q", "--out", "here"]) == 0
    assert rows_without_wall(tmp_path / "outputs" / "small") == rows_without_wall(tmp_path / "here")
    capsys.readouterr()


@pytest.mark.slow
def test_a_scheduler_that_does_not_answer_is_reported_within_seconds(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    with socket.socket() as silent:  # listens, and says nothing
        silent.bind(("127.0.0.1", 0))
        silent.listen()
        began = time.monotonic()
        address = f"tcp://127.0.0.1:{silent.getsockname()[1]}"
        assert main(["sweep", "outcome_map", "--scheduler", address]) == 2
        assert time.monotonic() - began < 30.0
    message = capsys.readouterr().err
    assert f"--scheduler {address}: no answer within 5 s" in message
    assert "leave --scheduler out" in message
    assert main(["sweep", "outcome_map", "--scheduler", "nonsense"]) == 2
    assert not (tmp_path / "outputs").exists()
