"""The case that a sweep or an ensemble varies: found beside its file, never outside."""

import pytest

from fem.case.files import CASES
from fem.case.validation import CaseError
from fem.study.file import load_ensemble, load_sweep

SWEEP = '[axes]\n"contact.mu_static" = [0.3, 0.4]\n'
ENSEMBLE = (
    'draws = 80\n[set]\n"solver.model" = "rigid"\n[axes]\n"contact.mu_static" = [0.3, 0.4]\n'
    '[random]\n"motion.phase_rad" = { distribution = "uniform", from = 0.0, to = 6.2832 }\n'
)
READERS = pytest.mark.parametrize("read, text", [(load_sweep, SWEEP), (load_ensemble, ENSEMBLE)])


def written(folder, text, case):
    folder.mkdir(exist_ok=True)
    path = folder / "many.toml"
    path.write_text(f'case = "{case}"\n{text}', encoding="utf-8")
    return path


@READERS
def test_a_file_beside_it_wins_over_a_shipped_case(tmp_path, read, text):
    (tmp_path / "seed_box").write_text(
        CASES.text("seed_box").replace("boxes = 1 ", "boxes = 2 "), encoding="utf-8"
    )
    assert read(written(tmp_path, text, "seed_box")).base.container.boxes == 2
    (tmp_path / "seed_box").unlink()
    assert read(written(tmp_path, text, "seed_box")).base.container.boxes == 1


@READERS
@pytest.mark.parametrize("case", ["../outside.toml", "/etc/hostname"])
def test_a_path_out_of_the_folder_is_refused(tmp_path, read, text, case):
    (tmp_path / "outside.toml").write_text("", encoding="utf-8")
    with pytest.raises(CaseError, match="case"):
        read(written(tmp_path / "inner", text, case))


@READERS
def test_a_key_that_is_set_and_varies_is_refused(tmp_path, read, text):
    path = written(tmp_path, text, "seed_box")
    changed = path.read_text(encoding="utf-8")
    changed = (
        changed.replace("[axes]", '"contact.mu_static" = 0.5\n[axes]')
        if "[set]" in changed
        else (changed + '[set]\n"contact.mu_static" = 0.5\n')
    )
    path.write_text(changed, encoding="utf-8")
    with pytest.raises(CaseError, match=r"\[set\] 'contact\.mu_static' varies as well"):
        read(path)
