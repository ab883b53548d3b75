"""Work for processes, in a module that they can import: what is in a test module has a name that only pytest knows."""

import os
import time


def who_works(chunk) -> int:
    """The process that works, after a short time."""
    time.sleep(0.05)
    return os.getpid()


def end_the_process(chunk) -> None:
    """Die, as for want of memory."""
    os._exit(9)
