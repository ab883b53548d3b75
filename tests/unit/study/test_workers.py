"""Processes that share the work of this one: copies of it where it has no other thread, new ones elsewhere."""

import subprocess
import sys
from textwrap import dedent

import pytest

SCRIPT = dedent(
    """
    import os, sys, threading
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    from fem.study import workers

    def told():
        return getattr(workers, "told", "nothing"), os.getpid() == int(os.environ["PARENT"])

    if __name__ == "__main__":
        os.environ["PARENT"] = str(os.getpid())
        workers.told = "before the start"
        if "beside" in sys.argv:
            threading.Thread(target=threading.Event().wait, daemon=True).start()
        with workers.LocalWorkers(2) as workers_of:
            pools = workers_of("rigid", int(sys.argv[1]))
            print([(*pool.executor.submit(told).result(), pool.count) for pool in pools])
    """
)
HERE = ("before the start", True)


@pytest.mark.skipif(sys.platform != "linux", reason="elsewhere no process is forked")
@pytest.mark.parametrize(
    ("count", "beside", "workers"),
    [
        ("64", [], [("before the start", False, 1), (*HERE, 1)]),
        ("64", ["beside"], [(*HERE, 2)]),
        pytest.param("2000", ["beside"], [("nothing", False, 1), (*HERE, 1)], marks=pytest.mark.slow),
    ],
)
def test_a_process_without_other_threads_is_forked_for_few_cases(tmp_path, count, beside, workers):
    """A new process would take a second or two, and know nothing of what this one has set."""
    script = tmp_path / "script.py"
    script.write_text(SCRIPT, encoding="utf-8")
    command = [sys.executable, str(script), count, *beside]
    ended = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60)
    assert ended.stdout.strip() == str(workers)
