"""The lock of a folder: one owner at a time, a live one never broken, a dead one no obstacle."""

import json
import os
import signal
import socket
import subprocess
import sys

import pytest

from fem.results.errors import FolderLockedError
from fem.results.folder import LOCK_NAME, OWNER_NAME, locked_folder

HOLD = """
import sys, time
from pathlib import Path
from fem.results.folder import locked_folder
with locked_folder(Path(sys.argv[1])):
    print("held", flush=True)
    time.sleep(60)
"""


@pytest.fixture
def holder(tmp_path):
    """Another process that holds the folder."""
    process = subprocess.Popen(
        [sys.executable, "-c", HOLD, str(tmp_path / "r")], stdout=subprocess.PIPE, text=True
    )
    try:
        assert process.stdout.readline() == "held\n"
        yield process
    finally:
        process.kill()
        process.wait()
        process.stdout.close()


def test_a_folder_is_made_held_once_and_released(tmp_path):
    folder = tmp_path / "a" / "b"
    with locked_folder(folder) as lock:
        with pytest.raises(FolderLockedError, match="this very process"), locked_folder(folder):
            pass
        lock.check()
        (folder / "result").write_text("")
    assert [path.name for path in folder.iterdir()] == ["result"]


def test_a_folder_that_stays_empty_is_removed_again(tmp_path):
    with pytest.raises(RuntimeError), locked_folder(tmp_path / "a" / "b"):
        raise RuntimeError
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("stopped", [False, True])
def test_a_live_owner_is_named_with_the_way_out_and_a_killed_one_is_no_obstacle(tmp_path, holder, stopped):
    if stopped:
        holder.send_signal(signal.SIGSTOP)
    with pytest.raises(FolderLockedError) as refused, locked_folder(tmp_path / "r"):
        pass
    message = str(refused.value)
    assert f"process {holder.pid} on {socket.gethostname()} since 20" in message
    assert "--out" in message
    holder.kill()
    holder.wait()
    assert (tmp_path / "r" / LOCK_NAME).is_file()
    with locked_folder(tmp_path / "r"):
        assert json.loads((tmp_path / "r" / OWNER_NAME).read_text())["pid"] == os.getpid()
