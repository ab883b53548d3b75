"""The folder of a run: whose it is, what is replaced, and what is never touched."""

import json
import math
import os
from pathlib import Path

import numpy as np
import pytest

from fem.results import run_folder
from fem.results.run_folder import (
    FolderError,
    OutputError,
    naming_what_cannot_be_written,
    open_run_folder,
    read_result,
    write_atomically,
)
from fem.run.run import held

CASE = {"case_text": "title = 'é'\n", "resolved_text": "schema = 1\n", "case_hash": "abc"}


def opened(path, **options):
    return open_run_folder(path, **{**CASE, **options})


def finish(folder, status="completed", **more):
    folder.history.write_text("old history\n")
    folder.fields.mkdir()
    (folder.fields / "frame_00000.vtu").write_text("old")
    (folder.fields / "run.pvd").write_text("old")
    folder.checkpoint.write_bytes(b"old")
    folder.write_result({"status": status, "case_hash": CASE["case_hash"], **more})


def test_new_folder_is_marked_as_running_with_its_case(tmp_path):
    folder = opened(tmp_path / "outputs" / "run")
    assert folder.finished is None
    assert json.loads(folder.result.read_text()) == {"status": "running", "case_hash": "abc"}
    assert folder.case.read_text(encoding="utf-8") == CASE["case_text"]
    assert folder.resolved.read_text() == CASE["resolved_text"]
    assert sorted(p.name for p in folder.path.iterdir()) == ["case.toml", "resolved.toml", "run.json"]


@pytest.mark.parametrize("status", ["completed", "overturned"])
def test_finished_run_of_the_same_case_is_not_touched(tmp_path, status):
    finish(opened(tmp_path), status, verdict={"outcome": "rock"})
    before = {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()}
    folder = opened(tmp_path)
    assert folder.finished["verdict"] == {"outcome": "rock"}
    assert {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()} == before


@pytest.mark.parametrize("status", ["running", "interrupted", "failed"])
def test_unfinished_run_is_begun_anew_without_its_old_results(tmp_path, status):
    finish(opened(tmp_path), status)
    folder = opened(tmp_path)
    assert folder.finished is None
    assert not folder.history.exists() and not folder.fields.exists() and not folder.checkpoint.exists()
    assert read_result(folder.result)["status"] == "running"


def test_resume_keeps_what_an_interrupted_run_left(tmp_path):
    finish(opened(tmp_path), "interrupted")
    folder = opened(tmp_path, resume=True)
    assert folder.finished is None
    assert folder.history.read_text() == "old history\n" and folder.checkpoint.read_bytes() == b"old"


def test_force_computes_a_finished_run_again(tmp_path):
    finish(opened(tmp_path))
    folder = opened(tmp_path, force=True, resume=True)
    assert folder.finished is None and not folder.history.exists()


def test_another_case_in_the_folder_is_refused_and_kept(tmp_path):
    finish(opened(tmp_path))
    before = {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()}
    with pytest.raises(FolderError, match=r"another case.*--out.*--force"):
        opened(tmp_path, case_hash="other")
    assert {p: p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()} == before


def test_force_replaces_another_case_and_resume_does_not_mix_with_it(tmp_path):
    finish(opened(tmp_path))
    folder = opened(tmp_path, case_hash="other", force=True, resume=True)
    assert read_result(folder.result) == {"status": "running", "case_hash": "other"}
    assert not folder.checkpoint.exists()


def test_folder_with_foreign_files_is_refused_and_force_leaves_them(tmp_path):
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(FolderError, match=r"not empty and holds no run.*--out.*--force"):
        opened(tmp_path)
    finish(opened(tmp_path, force=True))
    (tmp_path / "fields" / "notes.txt").write_text("mine")
    opened(tmp_path, force=True)
    assert (tmp_path / "thesis.tex").read_text() == "years of work"
    assert [p.name for p in (tmp_path / "fields").iterdir()] == ["notes.txt"]


def test_empty_folder_and_leavings_of_a_kill_are_taken(tmp_path):
    (tmp_path / ".run.json.part").write_text("{")
    assert opened(tmp_path).finished is None


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{",
        "[1]",
        '{"status": "completed"}',
        "\x00",
        '{"case_hash": "ours", "verdict": {"rotation_ratio": "abc"}}',
        '{"case_hash": "ours", "joints": [{"height_m": [1.0, "x"]}]}',
    ],
)
def test_damaged_result_is_refused_by_name(tmp_path, text):
    (tmp_path / "run.json").write_text(text)
    with pytest.raises(FolderError, match=r"run\.json: damaged.*--force"):
        opened(tmp_path)
    assert opened(tmp_path, force=True).finished is None


def test_a_file_in_place_of_the_folder_is_refused(tmp_path):
    (tmp_path / "x").write_text("")
    with pytest.raises(FolderError, match=r"is a file.*--out"):
        opened(tmp_path / "x")
    with pytest.raises(FolderError, match=r"--out"):
        opened(tmp_path / "x" / "y" / "z")


@pytest.mark.parametrize("below", ["", "deep", "deep/deeper"])
def test_a_link_to_nowhere_on_the_way_is_named(tmp_path, below):
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    place, words = (
        tmp_path / "link" / below,
        r"link is a link to .*nowhere, which is not there; choose another",
    )
    with pytest.raises(FolderError, match=words), held(place):
        pass
    with pytest.raises(FolderError, match=words), naming_what_cannot_be_written(place, "ask again"):
        place.mkdir(parents=True)
    assert [entry.name for entry in tmp_path.iterdir()] == ["link"]


def test_a_file_on_the_way_is_named(tmp_path):
    (tmp_path / "x").write_text("")
    with pytest.raises(FolderError, match=r"x is a file, not a folder; .*--out"), held(tmp_path / "x" / "y"):
        pass


def test_a_place_where_no_folder_can_be_made_is_not_one_that_was_written_to(tmp_path):
    place = tmp_path / "gone" / "r"
    with pytest.raises(FolderError, match="cannot be made"), naming_what_cannot_be_written(place, "wait"):
        place.mkdir()
    place.mkdir(parents=True)
    words = r"what was written before can be read.*wait"
    with pytest.raises(OutputError, match=words), naming_what_cannot_be_written(place, "wait"):
        place.rmdir()
        (place / "file").write_text("")


def test_folder_that_cannot_be_made_leaves_no_parents_behind(tmp_path, monkeypatch):
    make = Path.mkdir

    def refuse(self, *args, **kwargs):
        if self.name == "deep":
            make(self.parent, exist_ok=True)
            raise PermissionError(13, "Permission denied")
        make(self, *args, **kwargs)

    monkeypatch.setattr(Path, "mkdir", refuse)
    with pytest.raises(FolderError, match=r"cannot be made \(Permission denied\).*--out"):
        opened(tmp_path / "a" / "deep")
    assert list(tmp_path.iterdir()) == []


def test_full_disk_at_the_start_leaves_nothing_behind(tmp_path, monkeypatch):
    def full(path, text):
        if path.name == "resolved.toml":
            raise OSError(28, "No space left on device")
        write_atomically(path, text)

    monkeypatch.setattr(run_folder, "write_atomically", full)
    with pytest.raises(FolderError, match="No space left"):
        opened(tmp_path / "outputs" / "run")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_read_only_folder_is_refused(tmp_path):
    tmp_path.chmod(0o555)
    with pytest.raises(FolderError, match=r"--out"):
        opened(tmp_path)
    tmp_path.chmod(0o755)


def test_result_is_strict_json(tmp_path):
    folder = opened(tmp_path)
    folder.write_result(
        {
            "status": "completed",
            "case_hash": "abc",
            "a": np.float64(0.1),
            "b": math.nan,
            "c": np.array([1.0, math.inf]),
            "d": {"e": np.int64(3), "f": np.bool_(True), "g": None},
            "h": ("rest", "rock"),
            "i": frozenset({"slide", "rock"}),
        }
    )
    assert json.loads(folder.result.read_text(), parse_constant=pytest.fail) == {
        "status": "completed", "case_hash": "abc", "a": 0.1, "b": None, "c": [1.0, None],
        "d": {"e": 3, "f": True, "g": None}, "h": ["rest", "rock"], "i": ["rock", "slide"],
    }  # fmt: skip


def test_unknown_status_is_refused(tmp_path):
    with pytest.raises(ValueError, match="unknown status 'stable'"):
        opened(tmp_path).write_result({"status": "stable"})


def test_an_atomic_write_that_fails_keeps_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "run.json"
    write_atomically(path, "old")

    def fail(*_):
        raise OSError(5, "Input/output error")

    monkeypatch.setattr(os, "replace", fail)
    with pytest.raises(OSError, match="Input/output"):
        write_atomically(path, "new")
    assert [(p.name, p.read_text()) for p in tmp_path.iterdir()] == [("run.json", "old")]
