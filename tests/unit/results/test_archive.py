"""The file of a checkpoint: what comes back is what went in, and everything else is refused by name."""

import io
import json
import os
import struct
import zipfile

import numpy as np
import pytest

from contact.stepping.state import STEP_RECORD
from fem.results import archive as checkpoint
from fem.results.archive import ABOUT, CheckpointError, read_checkpoint, write_checkpoint

PROGRAM = {"unanchored": "0.1.0", "sources": "abc"}
OWN = {"case_hash": "ours", "program": PROGRAM}


def arrays():
    clock = np.zeros(1, STEP_RECORD)
    clock["time"], clock["steps"] = 0.1 + 0.2, 7
    return {
        "old.position": np.array([0.1, -0.0, np.nan, np.inf, 5e-324]),
        "work.pivot": np.arange(4).reshape(2, 2),
        "work.matrix": np.array([[1.0, 2.0], [3.0, 4.0]], order="F"),
        "clock": clock,
        "nothing": np.zeros((0, 2)),
    }


def read(path, case_hash="ours", program=PROGRAM):
    return read_checkpoint(path, case_hash=case_hash, program=program)


@pytest.fixture
def path(tmp_path):
    place = tmp_path / "checkpoint.npz"
    write_checkpoint(place, {**OWN, "time_s": 0.1 + 0.2}, arrays())
    return place


def test_what_goes_in_comes_back_bit_for_bit(path):
    found = read(path)
    assert found.about["time_s"] == 0.1 + 0.2
    assert set(found.arrays) == set(arrays())
    for name, array in arrays().items():
        assert found.arrays[name].dtype.descr == array.dtype.descr
        assert found.arrays[name].shape == array.shape
        assert found.arrays[name].tobytes() == array.tobytes()
    assert [entry.name for entry in path.parent.iterdir()] == [path.name]


def test_the_file_is_an_npz_that_numpy_reads_without_pickle(path):
    with np.load(path, allow_pickle=False) as archive:
        assert archive["work.pivot"].tolist() == [[0, 1], [2, 3]]


def test_objects_are_not_kept(tmp_path):
    with pytest.raises(ValueError, match="allow_pickle"):
        write_checkpoint(tmp_path / "c.npz", OWN, {"a": np.array([print], dtype=object)})
    assert list(tmp_path.iterdir()) == []


def test_a_checkpoint_cut_short_anywhere_is_refused(path):
    whole = path.read_bytes()
    for length in [0, 1, 10, *range(50, len(whole), 97), len(whole) - 1]:
        path.write_bytes(whole[:length])
        with pytest.raises(CheckpointError, match=r"checkpoint\.npz: damaged.*--force"):
            read(path)


def test_a_single_damaged_bit_anywhere_is_refused(path):
    whole = path.read_bytes()
    for at in range(0, len(whole), 7):
        damaged = bytearray(whole)
        damaged[at] ^= 1 << (at % 8)
        path.write_bytes(damaged)
        with pytest.raises(CheckpointError, match="damaged"):
            read(path)


@pytest.mark.parametrize("content", [b"", b"PK\x03\x04", b"\x93NUMPY\x01\x00", b"{}", os.urandom(5000)])
def test_what_is_no_checkpoint_is_refused(tmp_path, content):
    (tmp_path / "c.npz").write_bytes(content)
    with pytest.raises(CheckpointError, match=r"c\.npz: damaged, or no checkpoint.*--force"):
        read(tmp_path / "c.npz")


def test_a_folder_in_its_place_is_refused(tmp_path):
    with pytest.raises(CheckpointError, match="cannot be read"):
        read(tmp_path)


def test_another_case_is_refused(path):
    with pytest.raises(CheckpointError, match=r"belongs to another case.*--force"):
        read(path, case_hash="theirs")


def test_another_version_is_refused_and_named(path):
    with pytest.raises(CheckpointError, match=r"another version.*sources abc, here def.*--force"):
        read(path, program=PROGRAM | {"sources": "def"})


def test_another_format_is_refused(path, monkeypatch):
    monkeypatch.setattr(checkpoint, "FORMAT", checkpoint.FORMAT + 1)
    with pytest.raises(CheckpointError, match="another version"):
        read(path)


def forged(path, name, header, content=b"", compression=zipfile.ZIP_STORED):
    """An archive whose checksum is right, with one array that is not what it seems."""
    text = f"{header!r}".encode().ljust(118) + b"\n"
    array = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + content
    with zipfile.ZipFile(path, "w", compression) as archive:
        archive.writestr(ABOUT, json.dumps({"format": checkpoint.FORMAT, **OWN}))
        archive.writestr(name, array)
        archive.comment = bytes(checkpoint.DIGEST_LENGTH)
    content = path.read_bytes()[: -checkpoint.DIGEST_LENGTH]
    path.write_bytes(content + checkpoint._digest(content))


def test_an_array_that_claims_more_than_it_has_is_refused_without_taking_the_memory(tmp_path):
    for count in (10, 10**9, 10**15, 10**30):
        header = {"descr": "<f8", "fortran_order": False, "shape": (count,)}
        forged(tmp_path / "c.npz", "a.npy", header, bytes(16))
        with pytest.raises(CheckpointError, match="damaged"):
            read(tmp_path / "c.npz")


def test_a_pickle_is_refused(tmp_path):
    header = {"descr": "|O", "fortran_order": False, "shape": (1,)}
    forged(tmp_path / "c.npz", "a.npy", header, b"cos\nsystem\n(S'false'\ntR.")
    with pytest.raises(CheckpointError, match="allow_pickle"):
        read(tmp_path / "c.npz")


def test_an_archive_that_unpacks_to_more_than_it_is_is_refused(tmp_path):
    header = {"descr": "<f8", "fortran_order": False, "shape": (10**6,)}
    forged(tmp_path / "c.npz", "a.npy", header, bytes(8 * 10**6), zipfile.ZIP_DEFLATED)
    with pytest.raises(CheckpointError, match="it is compressed"):
        read(tmp_path / "c.npz")


def test_a_write_that_fails_keeps_the_old_checkpoint(path, monkeypatch):
    before = path.read_bytes()

    def full(*_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space"):
        write_checkpoint(path, OWN, {"a": np.zeros(3)})
    assert path.read_bytes() == before
    assert [entry.name for entry in path.parent.iterdir()] == [path.name]


def test_members_are_stored_in_full(path):
    with zipfile.ZipFile(io.BytesIO(path.read_bytes())) as archive:
        assert {entry.compress_type for entry in archive.infolist()} == {zipfile.ZIP_STORED}
