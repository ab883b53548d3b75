"""A folder of results, of whatever kind: whose it is, what is replaced, and what is never touched."""

import json
import math
import os

import numpy as np
import pytest
from interrupted_runs import files_of

from fem.results.errors import FolderError, writing_into
from fem.results.folder import open_result_folder, program_of_results, read_result
from fem.results.json_block import to_json
from fem.results.kinds import RUN, SWEEP
from fem.runtime.own_files import write_atomically

TEXTS = {"case.toml": "title = 'é'\n", "resolved.toml": "schema = 1\n"}
pytestmark = pytest.mark.parametrize("kind", [RUN, SWEEP], ids=lambda kind: kind.mark)


def mark(kind, status="running", request="ours", **more):
    return {"status": status, kind.request: request, **more}


def own_files(kind):
    """A file for every pattern of the kind."""
    return [pattern.replace("*", "00001") for pattern in kind.own if pattern not in TEXTS]


def computed(path, kind, status="completed", request="ours", **options):
    """Compute a result into a folder; returns what was found there."""
    with open_result_folder(path, kind, request, **options) as folder:
        if folder.finished:
            return folder
        folder.begin(mark(kind, request=request), TEXTS)
        for name in own_files(kind):
            folder.write(name, "old")
        folder.write_result(mark(kind, status, request))
    return folder


def test_a_new_folder_is_marked_as_running_with_what_was_asked(tmp_path, kind):
    place = tmp_path / "outputs" / "result"
    with open_result_folder(place, kind, "ours") as folder:
        assert (folder.earlier, folder.finished, folder.resuming) == (None, False, False)
        folder.begin(mark(kind), TEXTS)
    assert json.loads((place / kind.mark).read_text()) == mark(kind)
    assert (place / "case.toml").read_text(encoding="utf-8") == TEXTS["case.toml"]
    assert sorted(files_of(place)) == sorted([*TEXTS, kind.mark])


def test_a_finished_result_of_the_same_request_is_not_touched_unless_forced(tmp_path, kind):
    for status in kind.finished:
        computed(tmp_path, kind, status, force=True)
        before = files_of(tmp_path)
        assert computed(tmp_path, kind).earlier == mark(kind, status)
        assert files_of(tmp_path) == before
    with open_result_folder(tmp_path, kind, "ours", force=True, resume=True) as folder:
        assert not folder.finished and not folder.resuming
        folder.begin(mark(kind), TEXTS)
    assert sorted(files_of(tmp_path)) == sorted([*TEXTS, kind.mark])


@pytest.mark.parametrize("resume", [False, True])
@pytest.mark.parametrize("status", ["running", "interrupted", "failed"])
def test_an_unfinished_result_keeps_its_files_only_to_resume(tmp_path, kind, status, resume):
    computed(tmp_path, kind, status)
    for name in own_files(kind):  # as a kill leaves them
        (tmp_path / name).with_name(".part-0123456789abcdef").write_text("half")
    with open_result_folder(tmp_path, kind, "ours", resume=resume) as folder:
        assert folder.resuming is resume
        folder.begin(mark(kind), TEXTS)
    kept = own_files(kind) if resume else []
    assert sorted(files_of(tmp_path)) == sorted([*TEXTS, kind.mark, *kept])
    with (
        open_result_folder(tmp_path, kind, "ours") as folder,
        pytest.raises(FolderError, match=r"--resume.*--force"),
    ):
        folder.refuse_unfinished("3 of 7 rows")


def test_another_request_is_refused_and_force_replaces_it(tmp_path, kind):
    computed(tmp_path, kind)
    before = files_of(tmp_path)
    for options in ({}, {"resume": True}):
        with pytest.raises(FolderError, match=rf"another {kind.subject}.*--out.*--force"):
            computed(tmp_path, kind, request="theirs", **options)
    assert files_of(tmp_path) == before
    computed(tmp_path, kind, "failed", request="theirs", force=True, resume=True)
    assert read_result(tmp_path / kind.mark, kind) == mark(kind, "failed", "theirs")


def test_foreign_files_are_refused_and_survive_force(tmp_path, kind):
    for name in (".part-0123456789abcdef", ".lock", ".owner"):  # left by a kill: no obstacle
        (tmp_path / name).write_text("{")
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(FolderError, match=rf"not empty and holds no {kind.name}.*--out.*--force"):
        computed(tmp_path, kind)
    for _ in range(2):
        computed(tmp_path, kind, force=True)
        for folder in [entry for entry in tmp_path.iterdir() if entry.is_dir()]:
            (folder / "notes.txt").write_text("mine")
    with open_result_folder(tmp_path, kind, "ours", force=True) as folder:
        folder.begin(mark(kind))
    left = {path.name for path in tmp_path.rglob("*") if path.is_file()}
    assert left <= {"thesis.tex", "notes.txt", kind.mark, *TEXTS}
    assert "thesis.tex" in left


def test_the_result_of_another_kind_is_refused_and_force_replaces_it_whole(tmp_path, kind):
    other = SWEEP if kind is RUN else RUN
    computed(tmp_path, other)
    with pytest.raises(FolderError, match=rf"not empty and holds no {kind.name}.*--force"):
        computed(tmp_path, kind)
    with open_result_folder(tmp_path, kind, "ours", force=True) as folder:
        folder.begin(mark(kind), TEXTS)
    assert sorted(files_of(tmp_path)) == sorted([*TEXTS, kind.mark])


@pytest.mark.parametrize("text", ["", "{", "[1]", '{"status": "completed"}', "\x00"])
def test_a_damaged_mark_is_refused_by_name(tmp_path, kind, text):
    (tmp_path / kind.mark).write_text(text)
    with pytest.raises(FolderError, match=rf"{kind.mark}: damaged.*the result of.*--force"):
        computed(tmp_path, kind)
    assert computed(tmp_path, kind, force=True).earlier is None


def test_the_program_that_wrote_an_unfinished_result_must_be_this_one(tmp_path, kind):
    for changes, reason in (
        ({}, None),
        ({"program": "0"}, "of the program"),
        ({"versions": {}}, "version of python"),
    ):
        with open_result_folder(tmp_path, kind, "ours") as folder:
            folder.begin(mark(kind) | program_of_results() | changes)
        with open_result_folder(tmp_path, kind, "ours", resume=True) as folder:
            if reason is None:
                folder.require_same_program()
            else:
                with pytest.raises(FolderError, match=rf"another (version )?{reason}.*--force"):
                    folder.require_same_program()


def test_arrays_come_back_and_a_damaged_file_of_them_is_refused(tmp_path, kind):
    arrays = {"a": np.arange(3), "b": np.array([math.nan, 0.1])}
    with open_result_folder(tmp_path, kind, "ours") as folder:
        assert folder.read_arrays("state.npz") is None
        folder.write_arrays("state.npz", arrays)
        found = folder.read_arrays("state.npz")
        kept, wanted = ({name: one.tobytes() for name, one in some.items()} for some in (found, arrays))
        assert kept == wanted
        (tmp_path / "state.npz").write_bytes((tmp_path / "state.npz").read_bytes()[:-9])
        with pytest.raises(FolderError, match=r"state.npz: damaged.*--force"):
            folder.read_arrays("state.npz")


def test_a_file_or_a_broken_link_on_the_way_is_named(tmp_path, kind):
    (tmp_path / "file").write_text("")
    (tmp_path / "link").symlink_to(tmp_path / "nowhere")
    for place, reason in (
        (tmp_path / "file", "file is a file"),
        (tmp_path / "file" / "x" / "y", "file is a file"),
        (tmp_path / "link" / "x", "link is a link to .*nowhere, which does not exist"),
    ):
        with pytest.raises(FolderError, match=rf"{reason}.*--out DIR"):
            computed(place, kind)
        with pytest.raises(FolderError, match=reason), writing_into(place, "wait"):
            place.mkdir(parents=True)
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["file", "link"]


def test_a_result_is_strict_json_and_replaced_whole(tmp_path, kind, monkeypatch):
    content = {
        "a": np.float64(0.1), "b": math.nan, "c": np.array([1.0, math.inf]),
        "d": {"e": np.int64(3), "f": np.bool_(True), "g": None}, "h": ("rest",), "i": frozenset({"slide", "rock"}),
    }  # fmt: skip
    path = tmp_path / kind.mark
    write_atomically(path, to_json(content))
    assert json.loads(path.read_text(), parse_constant=pytest.fail) == {
        "a": 0.1, "b": None, "c": [1.0, None], "d": {"e": 3, "f": True, "g": None},
        "h": ["rest"], "i": ["rock", "slide"],
    }  # fmt: skip
    before = files_of(tmp_path)

    def fail(*_):
        raise OSError(5, "Input/output error")

    monkeypatch.setattr(os, "replace", fail)
    with pytest.raises(OSError, match="Input/output"):
        write_atomically(path, b"new")
    assert files_of(tmp_path) == before
