"""The lock of a folder: one owner at a time, a live one never broken, a dead one no obstacle."""

import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time

import pytest

from fem.results.errors import FolderError, FolderLockedError, FolderLostError
from fem.results.lock import LOCK_NAME, OWNER_NAME, locked_folder

HOLD = """
import sys, time
from pathlib import Path
from fem.results.lock import locked_folder
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


def test_a_folder_is_made_held_and_given_back(tmp_path):
    folder = tmp_path / "a" / "b"
    with locked_folder(folder) as lock:
        assert json.loads((folder / OWNER_NAME).read_text())["pid"] == os.getpid()
        lock.check()
        (folder / "result").write_text("")
    assert [path.name for path in folder.iterdir()] == ["result"]


def test_a_folder_that_stays_empty_is_removed_again(tmp_path):
    with pytest.raises(RuntimeError), locked_folder(tmp_path / "a" / "b"):
        raise RuntimeError
    assert list(tmp_path.iterdir()) == []


def test_the_same_process_does_not_hold_a_folder_twice(tmp_path):
    with locked_folder(tmp_path) as lock:
        with pytest.raises(FolderLockedError, match="this very process"), locked_folder(tmp_path):
            pass
        lock.check()
    with locked_folder(tmp_path):
        pass


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


@pytest.mark.parametrize("content", ["", "{", "[]", '{"pid": "x"}'])
def test_leftovers_of_a_lock_are_no_obstacle(tmp_path, content):
    (tmp_path / LOCK_NAME).write_text(content)
    (tmp_path / OWNER_NAME).write_text(content)
    with locked_folder(tmp_path):
        pass


def test_a_folder_lost_is_noticed_and_not_taken_from_the_next_owner(tmp_path):
    folder = tmp_path / "r"
    with locked_folder(folder) as lock:
        shutil.rmtree(folder)
        with locked_folder(folder) as other:
            with pytest.raises(FolderLostError, match="taken by another process"):
                lock.check()
            other.check()
        with pytest.raises(FolderLostError, match="was removed"):
            lock.check()


def test_of_many_that_want_a_folder_one_has_it(tmp_path):
    inside, most, got = 0, 0, 0
    guard, over = threading.Lock(), time.monotonic() + 1.0

    def want():
        nonlocal inside, most, got
        while time.monotonic() < over:
            try:
                with locked_folder(tmp_path / "r"):
                    with guard:
                        inside, got = inside + 1, got + 1
                        most = max(most, inside)
                    time.sleep(0.0005)
                    with guard:
                        inside -= 1
            except FolderLockedError:
                continue

    threads = [threading.Thread(target=want) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert most == 1 and got > 1


@pytest.mark.parametrize("place", ["/proc/nothing/there", "dangling/there", "file/there"])
def test_a_place_where_no_folder_can_be_made_is_refused_at_once(tmp_path, place):
    (tmp_path / "dangling").symlink_to(tmp_path / "gone")
    (tmp_path / "file").write_text("")
    began = time.monotonic()
    with pytest.raises(FolderError, match="--out DIR"), locked_folder(tmp_path / place):
        pass
    assert time.monotonic() - began < 10.0
