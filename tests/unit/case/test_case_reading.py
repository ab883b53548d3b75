"""Reading a case file: where it is found, and bytes that are none; what its keys mean is in `said/cases.txt`."""

import pytest
from cases import LEAST

from fem.case.case import CaseError, load_case


def test_mark_and_line_ends_of_windows_are_read(tmp_path):
    path = tmp_path / "case.toml"
    path.write_bytes(b"\xef\xbb\xbf" + LEAST.replace("\n", "\r\n").encode())
    assert load_case(path).container.width_m == 1.1


def test_a_file_wins_over_a_shipped_case_of_its_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "seed_box").write_text(LEAST, encoding="utf-8")
    assert load_case("seed_box").container.section == "solid"
    (tmp_path / "seed_box").unlink()
    (tmp_path / "seed_box").mkdir()
    assert load_case("seed_box").container.section == "shell"


def test_a_case_knows_where_it_comes_from(tmp_path):
    path = tmp_path / "drum.toml"
    path.write_text(LEAST, encoding="utf-8")
    case = load_case(path, ["contact.mu_static=0.3"])
    assert (case.name, case.folder, case.text) == ("drum", tmp_path, LEAST)
    assert case.overrides == ("contact.mu_static=0.3",)


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"a = " + b"[" * 5000, "nested too deep"),
        (b"a = " + b"9" * 5000, "not a TOML file"),
        (b"\xff\xfe[\x00c\x00", "not text in UTF-8"),
        (b"title = '\xe4'", "not text in UTF-8 (line 1)"),
        (b"# " + b"x" * 1_000_001, "larger than 1 MB"),
    ],
)
def test_bytes_that_are_no_case_file_are_refused_with_their_place(tmp_path, content, expected):
    path = tmp_path / "case.toml"
    path.write_bytes(content)
    with pytest.raises(CaseError) as refused:
        load_case(path)
    assert expected in str(refused.value) and str(path) in str(refused.value)


@pytest.mark.parametrize("name", ["", "no\0name", "x" * 5000])
def test_a_case_that_cannot_be_there_is_refused_with_the_shipped_ones(name):
    with pytest.raises(CaseError, match="seed_stack"):
        load_case(name)
