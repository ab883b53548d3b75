"""The lock of a folder: one owner at a time, stale ones recognised, live ones never broken."""

import json
import os
import signal
import socket
import subprocess
import sys
import threading
import time

import pytest

from fem.results import lock as folder_lock
from fem.results.lock import LOCK_NAME, SILENCE_S, FolderLockedError, FolderLostError, held_folder

HOLD = """
import sys, time
from pathlib import Path
from fem.results.lock import held_folder
with held_folder(Path(sys.argv[1])):
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


def leave_lock(folder, **changes):
    """A lock as its owner wrote it, with nobody behind it who holds the file."""
    folder.mkdir(exist_ok=True)
    with held_folder(folder):
        content = json.loads((folder / LOCK_NAME).read_text())
    (folder / LOCK_NAME).write_text(json.dumps(content | changes))


def test_a_folder_is_made_held_and_given_back(tmp_path):
    folder = tmp_path / "a" / "b"
    with held_folder(folder) as lock:
        assert json.loads((folder / LOCK_NAME).read_text())["pid"] == os.getpid()
        lock.check()
        (folder / "result").write_text("")
    assert [path.name for path in folder.iterdir()] == ["result"]


def test_a_folder_in_which_nothing_came_to_lie_goes_again(tmp_path):
    with pytest.raises(RuntimeError), held_folder(tmp_path / "a" / "b"):
        raise RuntimeError
    assert list(tmp_path.iterdir()) == []


def test_the_same_process_does_not_hold_a_folder_twice(tmp_path):
    with held_folder(tmp_path):
        with pytest.raises(FolderLockedError, match="this very process"), held_folder(tmp_path):
            pass
        assert (tmp_path / LOCK_NAME).is_file()
    with held_folder(tmp_path):
        pass


def test_another_process_is_named_with_the_way_out(tmp_path, holder):
    with pytest.raises(FolderLockedError) as refused, held_folder(tmp_path / "r"):
        pass
    message = str(refused.value)
    assert f"process {holder.pid} on {socket.gethostname()} since 20" in message
    assert "--out" in message


def test_a_killed_owner_is_followed_at_once(tmp_path, holder):
    holder.kill()
    holder.wait()
    assert (tmp_path / "r" / LOCK_NAME).is_file()
    with held_folder(tmp_path / "r"):
        assert json.loads((tmp_path / "r" / LOCK_NAME).read_text())["pid"] == os.getpid()


def test_a_stopped_owner_is_an_owner(tmp_path, holder):
    holder.send_signal(signal.SIGSTOP)
    with pytest.raises(FolderLockedError), held_folder(tmp_path / "r"):
        pass


@pytest.mark.skipif(not os.path.exists("/proc/self/stat"), reason="the start of a process is read from /proc")
def test_a_number_that_now_belongs_to_another_process_is_no_owner(tmp_path):
    leave_lock(tmp_path, pid=os.getppid(), started="1")
    with held_folder(tmp_path):
        pass


def test_a_lock_of_an_earlier_boot_is_stale_once_silent(tmp_path):
    leave_lock(tmp_path, boot="another")
    os.utime(tmp_path / LOCK_NAME, (0, time.time() - SILENCE_S - 5))
    with held_folder(tmp_path):
        pass


def test_another_host_is_believed_while_it_is_heard_of(tmp_path):
    leave_lock(tmp_path, host="elsewhere", pid=1)
    with pytest.raises(FolderLockedError, match=r"process 1 on elsewhere.*last heard of 0 s ago"):
        held_folder(tmp_path).__enter__()
    os.utime(tmp_path / LOCK_NAME, (0, time.time() - SILENCE_S - 5))
    with held_folder(tmp_path):
        pass


def test_an_owner_where_flock_does_not_work_counts_by_his_word(tmp_path, monkeypatch, holder):
    monkeypatch.setattr(folder_lock, "fcntl", None)
    with pytest.raises(FolderLockedError, match=f"process {holder.pid}"), held_folder(tmp_path / "r"):
        pass
    holder.kill()
    holder.wait()
    with held_folder(tmp_path / "r"):
        pass


@pytest.mark.parametrize("content", ["", "{", "[]", '{"pid": "x"}', '{"pid": -1, "host": "", "boot": "",'])
def test_a_damaged_lock_that_nobody_holds_is_taken(tmp_path, content):
    (tmp_path / LOCK_NAME).write_text(content)
    with held_folder(tmp_path):
        pass


def test_a_sign_of_life_is_given(tmp_path, monkeypatch):
    monkeypatch.setattr(folder_lock, "HEARTBEAT_S", 0.02)
    with held_folder(tmp_path):
        os.utime(tmp_path / LOCK_NAME, (0, 0))
        end = time.monotonic() + 10.0
        while (tmp_path / LOCK_NAME).stat().st_mtime == 0 and time.monotonic() < end:
            time.sleep(0.01)
        assert (tmp_path / LOCK_NAME).stat().st_mtime > 0


def test_a_folder_lost_is_noticed_and_not_taken_from_the_next_owner(tmp_path):
    folder = tmp_path / "r"
    with held_folder(folder) as lock:
        (folder / LOCK_NAME).unlink()
        with held_folder(folder) as other:
            with pytest.raises(FolderLostError, match="taken by another process"):
                lock.check()
            other.check()
        folder.rmdir()
        with pytest.raises(FolderLostError, match="was removed"):
            lock.check()


def test_of_many_that_want_a_folder_one_has_it(tmp_path):
    inside, most, got = 0, 0, 0
    guard, over = threading.Lock(), time.monotonic() + 1.0

    def want():
        nonlocal inside, most, got
        while time.monotonic() < over:
            try:
                with held_folder(tmp_path / "r"):
                    with guard:
                        inside, got = inside + 1, got + 1
                        most = max(most, inside)
                    time.sleep(0.0005)
                    with guard:
                        inside -= 1
            except (FolderLockedError, FileNotFoundError):
                continue

    threads = [threading.Thread(target=want) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert most == 1 and got > 1


@pytest.mark.parametrize("place", ["/proc/nothing/there", "dangling/there"])
def test_a_place_where_no_folder_can_be_made_is_told_and_not_waited_for(tmp_path, place):
    (tmp_path / "dangling").symlink_to(tmp_path / "gone")
    began = time.monotonic()
    with pytest.raises(OSError, match=r"No such file|File exists"), held_folder(tmp_path / place):
        pass
    assert time.monotonic() - began < 10.0
