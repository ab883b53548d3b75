"""Folders from which compiled code is loaded and run: others must not be able to put files there."""

import os
import stat
from pathlib import Path


def open_to_others(*folders: Path) -> Path | None:
    """The first of nested folders, the innermost first, that belongs to another user or that others may write.

    Root's are as good as the user's own, and so is the right to write of the user's own group. Of the outermost others
    may write if it is sticky, as /tmp: nobody replaces there what is another's.
    """
    for folder in folders if hasattr(os, "getuid") else ():
        state = folder.stat()
        ours = state.st_uid in (os.getuid(), 0)
        sticky = state.st_mode & stat.S_ISVTX and folder is folders[-1]
        shared = stat.S_IWOTH | (stat.S_IWGRP if state.st_gid != os.getgid() else 0)
        if not ours or (state.st_mode & shared and not sticky):
            return folder
    return None
