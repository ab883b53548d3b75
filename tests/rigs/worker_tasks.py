"""Work for processes, in a module that they can import: what is in a test module has a name that only pytest knows."""

import os
import signal
import time


def who_works(chunk) -> int:
    """The process that works, after a short time."""
    time.sleep(0.05)
    return os.getpid()


def hear_the_group_end(chunk) -> int:
    """Receive the signal by which a batch scheduler ends a job, and work on."""
    os.kill(os.getpid(), signal.SIGTERM)
    return who_works(chunk)


def held_back(chunk) -> set[int]:
    """Signals that this process has not let through from its first moment on."""
    return {int(one) for one in signal.pthread_sigmask(signal.SIG_BLOCK, ())}


def end_the_process(chunk) -> None:
    """Die, as for want of memory."""
    os._exit(9)
