"""A folder from somebody else: nothing is written through a link, nothing blocks, all is told by file and key."""

import json
import os
import random
import re
import sys

import numpy as np
import pytest
import study_folders
from cases import BLOCK

from fem.__main__ import main
from fem.results.errors import FolderError
from fem.results.fields import FieldWriter
from fem.results.folder import open_result_folder, read_result
from fem.results.history import HistoryWriter
from fem.results.json_block import to_json
from fem.results.kinds import KINDS, RUN, SWEEP, typed_result
from fem.results.reader import open_run
from fem.results.run_result import RunResult
from fem.runtime import own_files
from fem.runtime.terminal import shown
from fem.runtime.user_files import parsed_json
from fem.study.driver import LoggedRuns, StudyResult
from fem.study.table import fields_of, line_of

CASE = BLOCK.replace("[container]", "schema = 1\n[container]", 1).lstrip()
VALUES = (None, True, -1, 1e308, "x", "", [], {}, [1], ["a"], {"a": 1}, [[1]], 10**400, [None])
FORGED = "x\\n-- passed --\\n"  #: of TOML, where it would be a line of its own
LINKED = "is a link, through which no results are written"


@pytest.fixture
def victim(tmp_path):
    """A file of the user, which nothing may touch."""
    path = tmp_path / "victim"
    path.write_text("mine")
    yield path
    assert path.read_text() == "mine" and not path.is_symlink()


@pytest.fixture
def folder(tmp_path):
    place = tmp_path / "out"
    place.mkdir()
    return place


def _places(content, above=""):
    """The containers and keys of all values at any depth, and the name that is nearest."""
    for key, value in content.items() if isinstance(content, dict) else enumerate(content):
        name = key if isinstance(key, str) else above
        yield content, key, name
        if isinstance(value, dict | list):
            yield from _places(value, name)


def begun(folder, kind=RUN, **options):
    with open_result_folder(folder, kind, "ours", **options) as place:
        place.begin({"status": "running", kind.request: "ours"})


class TestWriting:
    """Through no link, to no place that somebody else can foresee."""

    @pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
    def test_half_written_files_have_names_that_nobody_can_foresee(self, folder, victim, kind, monkeypatch):
        for name in (f".{kind.mark}.part", "..owner.part", ".owner", kind.mark):
            (folder / name).symlink_to(victim)
        names = []
        replace = os.replace
        monkeypatch.setattr(own_files.os, "replace", lambda a, b: (names.append(str(a)), replace(a, b)))
        begun(folder, kind, force=True)
        assert not (folder / kind.mark).is_symlink()
        assert len(set(names)) == len(names) > 1 and all(own_files.PART.search(name) for name in names)

    def test_a_file_is_made_with_the_mode_of_the_umask_and_replaces_a_link(self, folder, victim):
        (folder / "a").symlink_to(victim)
        before = os.umask(0o027)
        try:
            own_files.write_atomically(folder / "a", "new")
        finally:
            os.umask(before)
        assert (folder / "a").read_text() == "new" and (folder / "a").stat().st_mode & 0o777 == 0o640
        assert os.listdir(folder) == ["a"]

    def test_a_new_file_follows_no_link(self, folder, victim):
        (folder / "a").symlink_to(victim)
        (folder / "b").symlink_to(folder / "nowhere")
        for name in "ab":
            with pytest.raises(FileExistsError):
                own_files.created(folder / name)
        assert main(["init", "--to", str(folder / "b")]) == 2 and not (folder / "nowhere").exists()

    @pytest.mark.parametrize("how", ["symlink_to", "hardlink_to"])
    def test_a_log_is_no_link(self, folder, victim, how):
        log, unused = folder / "rows.csv", dict.fromkeys(("what", "key", "ids", "make", "model_of"))
        getattr(log, how)(victim)
        for write in (
            lambda: LoggedRuns(path=log, columns={}, **unused).run(None, []),
            lambda: HistoryWriter(log, ["time_s", "mode"], position=2),
        ):
            with pytest.raises(OSError, match=r"is (a link|another file's name, or no file), through which"):
                write()

    @pytest.mark.parametrize("subfolder", ["figures", "fields"])
    def test_a_subfolder_is_no_link(self, folder, tmp_path, subfolder):
        pictures = tmp_path / "pictures"
        pictures.mkdir()
        mine = [pictures / "a.svg", pictures / "frame_00001.vtu"]
        for path in mine:
            path.write_text("mine")
        (folder / subfolder).symlink_to(pictures)
        with pytest.raises(FolderError, match=rf"{subfolder} {LINKED}"):
            begun(folder, force=True)
        with pytest.raises(OSError, match=LINKED):
            cells = {"points": np.zeros((4, 2)), "cells": np.zeros((1, 4)), "region": np.zeros(1)}
            FieldWriter(folder / subfolder, **cells, box=[])
        assert all(path.read_text() == "mine" for path in mine) and len(os.listdir(pictures)) == 2

    def test_copies_follow_no_link(self, folder, tmp_path):
        elsewhere = tmp_path / "elsewhere"
        elsewhere.mkdir()
        (folder / "data").symlink_to(elsewhere)
        with pytest.raises(OSError, match=LINKED):
            own_files.place_in(folder, "data/motions/a.csv")
        assert not os.listdir(elsewhere)


class TestForce:
    """`--force` deletes files of a user from a folder without a mark of ours only by name."""

    @pytest.fixture(autouse=True)
    def files(self, folder):
        (folder / "figures").mkdir()
        for name in ("history.csv", "figures/a.svg", "thesis.tex"):
            (folder / name).write_text("mine")

    def test_it_lists_them_and_deletes_nothing(self, folder):
        words = r"--force deletes files there: history\.csv, figures/a\.svg; delete"
        with pytest.raises(FolderError, match=words):
            begun(folder, force=True)
        assert (folder / "history.csv").exists() and not (folder / "run.json").exists()

    @pytest.mark.parametrize(("answer", "deleted"), [("out", True), ("y", False), ("", False)])
    def test_it_asks_for_the_name_of_the_folder(self, folder, monkeypatch, answer, deleted):
        monkeypatch.setattr(sys.stdin, "isatty", lambda: True, raising=False)
        monkeypatch.setattr("builtins.input", lambda _: answer)
        if deleted:
            begun(folder, force=True)
        else:
            with pytest.raises(FolderError, match="nothing was deleted"):
                begun(folder, force=True)
        assert (folder / "history.csv").exists() is not deleted and (folder / "thesis.tex").exists()

    def test_a_folder_that_a_result_marks_needs_no_question(self, folder):
        (folder / "run.json").write_text("damaged")
        begun(folder, force=True)
        assert not (folder / "history.csv").exists()


class TestReading:
    """Only regular files, within limits, of the types that keys have."""

    @pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
    def test_a_pipe_does_not_block(self, folder, kind):
        os.mkfifo(folder / kind.mark)
        words = r"cannot be read \(is a device or a pipe, not a regular file\)"
        with pytest.raises(FolderError, match=words):
            read_result(folder / kind.mark, kind)
        (folder / kind.mark).unlink()
        (folder / kind.mark).symlink_to("/dev/zero")
        with pytest.raises(FolderError, match="is a device"):
            read_result(folder / kind.mark, kind)

    @pytest.mark.parametrize(
        "text", ["[" * 200_000, '{"a":' * 5_000 + "1" + "}" * 5_000, "[" * 50 + "]" * 50]
    )
    def test_deep_nesting_is_refused(self, folder, text):
        with pytest.raises(ValueError, match=r"nested too deeply|Expecting"):
            parsed_json(text)
        (folder / "run.json").write_text(text)
        with pytest.raises(FolderError, match="damaged, or not the result of a run"):
            read_result(folder / "run.json")

    @pytest.mark.parametrize(
        ("kind", "result", "content", "words"),
        [
            (RUN, RunResult, {"verdict": {"outcome": 5}}, "verdict.outcome is none of rest, slide, "),
            (RUN, RunResult, {"verdict": {"max_slip_m": "x"}}, "verdict.max_slip_m is no number"),
            (RUN, RunResult, {"verdict": 1}, "verdict is no table"),
            (SWEEP, StudyResult, {"answer": ["yes"]}, "answer is no text"),
            (SWEEP, StudyResult, {"versions": {"numpy": 3}}, "versions.numpy is no text"),
            (SWEEP, StudyResult, {"versions": []}, "versions is no table"),
        ],
    )
    def test_a_value_of_another_type_is_told_with_file_and_key(self, folder, kind, result, content, words):
        with pytest.raises(FolderError, match=rf"{kind.mark}: damaged, {re.escape(words)}"):
            typed_result(result, content, folder / kind.mark)

    @pytest.mark.parametrize("name", ["ensemble", "response"])
    def test_any_value_in_place_of_another_is_shown_or_refused_with_file_and_key(self, folder, capsys, name):
        getattr(study_folders, f"{name}_folder")(folder)
        mark, codes = folder / f"{name}.json", []
        content, draw = json.loads(mark.read_text()), random.Random(1)
        for place, key, known in draw.choices([*_places(content)], k=40):
            before, place[key] = place[key], draw.choice(VALUES)
            mark.write_text(json.dumps(content).replace("1e+308", "1e309"))
            place[key] = before
            codes.append(main(["report", str(folder), "-q"]))
            said = capsys.readouterr().err
            assert codes[-1] == 0 or re.search(rf"{name}\.json: damaged.*\b{known}\b", said), said
        assert set(codes) == {0, 2}

    def test_any_value_of_a_run_is_read_or_refused_with_the_file(self, gallery, tmp_path):
        folder = gallery.copy("rests", tmp_path)
        content, draw, refused = json.loads((folder / "run.json").read_text()), random.Random(1), 0
        for place, key, known in draw.choices([*_places(content)], k=200):
            before, place[key] = place[key], draw.choice(VALUES)
            (folder / "run.json").write_text(json.dumps(content).replace("1e+308", "1e309"))
            place[key] = before
            try:
                assert open_run(folder).typed_result.to_json()
            except FolderError as error:
                refused += 1
                assert re.search(rf"run\.json: .*\b{known}\b", str(error)), error
        assert 20 < refused < 190


class TestSpeaking:
    """Texts of others neither act on the terminal nor in a spreadsheet."""

    def test_control_characters_are_shown_as_escapes(self, tmp_path, capsys):
        bad = "\x1b]0;x\x07\x9b2J\u202egnp.exe\u2066\u200b\r"
        escaped = "".join(c if c.isascii() and c.isprintable() else f"\\u{ord(c):04x}" for c in bad)
        assert shown(f"ä{bad}\n\t") == f"ä{escaped}\n\t"
        assert json.loads(shown(to_json({"a": bad}))) == {"a": bad}
        path = tmp_path / "case.toml"
        title = "".join(f"\\u{ord(c):04x}" for c in bad)
        path.write_text(f'schema = 1\ntitle = "{title}"\n' + CASE.partition("\n")[2])
        assert main(["check", str(path)]) == 0
        path.write_text(f"title = {bad}")
        assert main(["check", str(path)]) == 2
        assert main(["run", f"no{bad}where"]) == 2
        told = "".join(capsys.readouterr())
        assert "gnp.exe" in told and not set("\x1b\x07\x9b\u202e\u2066\u200b\r") & set(told)

    @pytest.mark.parametrize(
        ("arguments", "more", "code"),
        [
            (["check", "case.toml"], f'title = "{FORGED}"', 0),
            (["check", "case.toml"], f'["{FORGED}"]', 2),
            (["check", "case.toml"], f'limits = "{FORGED}"', 2),
            (["report", "case\n-- passed --"], "", 2),
            (["check", "case.toml", "--x\n-- passed --"], "", 2),
            (["run", "case.toml", "--out", "out", "--force"], "", 2),
            (["report", "study"], "", 2),
            (["batch", "list.csv", "--case", "case.toml", "--out", "list", "--margins", "none"], "", 0),
        ],
    )
    def test_a_text_has_no_line_of_its_own(
        self, folder, tmp_path, capsys, monkeypatch, arguments, more, code
    ):
        monkeypatch.chdir(tmp_path)
        (folder / "figures").mkdir()
        (folder / "figures" / "a\n-- passed --.svg").write_text("mine")
        study_folders.ensemble_folder(tmp_path / "study", versions={"a\n-- passed --\n": 3})
        (tmp_path / "list.csv").write_text('name,width_m,"x\n-- passed --"\n"x\n-- passed --",1,2\nb,-1,1\n')
        (tmp_path / "case.toml").write_text(CASE.replace("[container]", f"{more}\n[container]"))
        assert main(arguments) == code
        told = "".join(capsys.readouterr())
        assert "-- passed --" in told and "\n-- passed --" not in told

    @pytest.mark.parametrize(
        ("text", "field"),
        [
            ("=1+1", "'=1+1"), ("A;=1+1", '"A;\'=1+1"'), ("x; @sum", '"x; \'@sum"'), ("-3.2", "-3.2"),
            ("-3 m", "'-3 m"), ("a;b", '"a;b"'), ("\t=1", "'=1"), ("'=1", "''=1"), ("it's -5", "it's -5"),
            ("a|+x", "a|'+x"),
        ],
    )  # fmt: skip
    def test_what_a_spreadsheet_would_compute_is_marked_and_read_back(self, text, field):
        line = line_of([text, -3.2])
        assert line == f"{field},-3.2" and fields_of(line) == [text.strip(), "-3.2"]
