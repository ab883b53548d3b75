"""The file of a checkpoint: what comes back is what went in, and everything else is refused by name."""

import hashlib
import json
import os
import struct
import zipfile

import numpy as np
import pytest

from contact.stepping.state import STEP_RECORD
from fem.results.archive import ABOUT, FORMAT, CheckpointError, read_checkpoint, write_archive

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
    write_archive(place, {**OWN, "time_s": 0.1 + 0.2}, arrays())
    return place


def test_what_goes_in_comes_back_bit_for_bit_and_numpy_reads_it_as_well(path):
    found = read(path)
    assert found.about["time_s"] == 0.1 + 0.2
    assert set(found.arrays) == set(arrays())
    with np.load(path, allow_pickle=False) as archive:
        for name, array in arrays().items():
            for one in (found.arrays[name], archive[name]):
                assert (one.dtype.descr, one.shape) == (array.dtype.descr, array.shape)
                assert one.tobytes() == array.tobytes()


def test_a_checkpoint_cut_short_or_with_a_wrong_bit_anywhere_is_refused(path):
    whole = path.read_bytes()
    spoiled = [whole[:length] for length in [0, 1, 10, *range(50, len(whole), 97), len(whole) - 1]]
    for at in range(0, len(whole), 7):
        spoiled.append(whole[:at] + bytes([whole[at] ^ 1 << (at % 8)]) + whole[at + 1 :])
    for content in [*spoiled, b"{}", b"\x93NUMPY\x01\x00", os.urandom(5000)]:
        path.write_bytes(content)
        with pytest.raises(CheckpointError, match=r"checkpoint\.npz: damaged, or not a checkpoint.*--force"):
            read(path)


@pytest.mark.parametrize(
    ("asked", "words"),
    [
        ({"case_hash": "theirs"}, r"belongs to another case.*--force"),
        ({"program": PROGRAM | {"sources": "def"}}, r"another version.*sources abc, here def.*--force"),
        ({"program": {"sources": "abc"}}, "another version"),
    ],
)
def test_a_checkpoint_of_another_case_or_version_is_refused(path, asked, words):
    with pytest.raises(CheckpointError, match=words):
        read(path, **asked)


def forged(path, header, content, compression):
    """An archive whose checksum is right, with one array that is not what it seems."""
    text = f"{header!r}".encode().ljust(118) + b"\n"
    array = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(text)) + text + content
    with zipfile.ZipFile(path, "w", compression) as archive:
        archive.writestr(ABOUT, json.dumps({"format": FORMAT, **OWN}))
        archive.writestr("a.npy", array)
        archive.comment = bytes(64)
    content = path.read_bytes()[:-64]
    path.write_bytes(content + hashlib.sha256(content).hexdigest().encode())


@pytest.mark.parametrize(
    ("header", "content", "compression", "words"),
    [
        ({"descr": "<f8", "shape": (10,)}, bytes(16), zipfile.ZIP_STORED, "damaged"),
        ({"descr": "<f8", "shape": (10**30,)}, bytes(16), zipfile.ZIP_STORED, "damaged"),
        ({"descr": "|O", "shape": (1,)}, b"cos\nsystem\n(S'false'\ntR.", zipfile.ZIP_STORED, "allow_pickle"),
        ({"descr": "<f8", "shape": (10**6,)}, bytes(8 * 10**6), zipfile.ZIP_DEFLATED, "it is compressed"),
    ],
)
def test_an_array_that_is_not_what_it_seems_is_refused(tmp_path, header, content, compression, words):
    # .. without taking the memory that it claims, and without running what a pickle holds
    forged(tmp_path / "c.npz", header | {"fortran_order": False}, content, compression)
    with pytest.raises(CheckpointError, match=words):
        read(tmp_path / "c.npz")
