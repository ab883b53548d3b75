"""Mesh and motion files are looked for beside the case file; what its user names may lie anywhere."""

import pytest
from cases import TABLE

from fem.case.case import CaseError, case_hash, load_case


def written(folder, name):
    folder.mkdir(exist_ok=True)
    path = folder / "case.toml"
    path.write_text(TABLE.replace("floor.csv", name), encoding="utf-8")
    return path


def case_in(folder, name, **options):
    return load_case(written(folder, name), **options)


def recorded(path):
    path.parent.mkdir(exist_ok=True)
    path.write_text("0,0\n1,0\n", encoding="utf-8")
    return path


def test_found_beside_the_case_file(tmp_path):
    record = recorded(tmp_path / "sub" / "floor.csv")
    assert case_in(tmp_path, "sub/floor.csv").data_files == {"motion.file": record}


def test_a_link_that_leads_out_of_the_folder_is_refused(tmp_path):
    folder = tmp_path / "case"
    folder.mkdir()
    (folder / "floor.csv").symlink_to(recorded(tmp_path / "secret.csv"))
    with pytest.raises(CaseError, match="must lie in the folder of the case file"):
        assert case_in(folder, "floor.csv").data_files
    assert case_in(folder, "floor.csv", allow_outside=True).data_files


@pytest.mark.parametrize("name", ["../floor.csv", "/etc/passwd", "C:/a.csv"])
def test_a_case_file_may_not_lead_out_of_its_folder(tmp_path, name):
    with pytest.raises(CaseError, match=r"\[motion\] file must name a file in the folder.*--allow-outside"):
        case_in(tmp_path / "case", name)


def test_allowed_outside_and_named_by_the_user(tmp_path):
    record = recorded(tmp_path / "floor.csv")
    allowed = case_in(tmp_path / "case", "../floor.csv", allow_outside=True)
    path = written(tmp_path / "case", "floor.csv")
    for case in (
        allowed,
        load_case(path, [f"motion.file={record}"]),
        load_case(path, ["motion.file=../floor.csv"]),
        load_case(path, motion=str(record)),
    ):
        assert case.data_files["motion.file"].resolve() == record
        assert case.resolved()["motion"]["file"] == "data/floor.csv"
        assert case_hash(case) == case_hash(allowed)


def test_a_motion_is_named_relative_to_the_current_folder(tmp_path, monkeypatch):
    path = written(tmp_path / "case", "floor.csv")
    beside = recorded(tmp_path / "case" / "mine.csv")
    monkeypatch.chdir(tmp_path)
    case = load_case(path, motion="case/mine.csv")
    assert case.motion.file == "mine.csv" and case.data_files["motion.file"].resolve() == beside
    harmonic = load_case("seed_stack", motion="case/mine.csv")
    assert harmonic.motion.kind == "table" and harmonic.data_files["motion.file"].resolve() == beside


def test_a_value_of_a_study_is_not_the_users(tmp_path):
    path = written(tmp_path / "case", "floor.csv")
    case = load_case(path, [f"motion.file={recorded(tmp_path / 'floor.csv')}"])
    with pytest.raises(CaseError, match="must name a file in the folder"):
        case.with_values({"motion.file": "../other.csv"})
    assert case.with_values({"contact.mu_static": 0.3}).data_files


def test_a_channel_is_no_part_of_the_name(tmp_path):
    record = recorded(tmp_path / "floor.csv")
    (file,) = case_in(tmp_path, "floor.csv#HNE").files.values()
    assert (file.path, file.channel, str(file.copy)) == (record, "HNE", "floor.csv")
    whole = recorded(tmp_path / "a#2")
    (file,) = case_in(tmp_path, "a#2").files.values()
    assert (file.path, file.channel, str(file.copy)) == (whole, "", "a#2")


def test_files_of_one_name_from_two_folders_are_refused(tmp_path):
    for folder in ("a", "b"):
        recorded(tmp_path / folder / "floor.csv")
    names = ["motion.file=../a/floor.csv", "vertical.kind=table", "vertical.file=../b/floor.csv"]
    case = load_case(written(tmp_path / "case", "floor.csv"), names)
    words = r"\[vertical\] file has the name of the file of motion.file, 'floor.csv'"
    with pytest.raises(CaseError, match=words):
        assert case.files
