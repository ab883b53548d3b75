"""Members of a band that are finished, in the folder of the run: a band that was cut off loses those under way alone.

The file `band.json` is replaced whole whenever a member is finished, and goes when the band is. It holds for the case
and the program that wrote it; another's is passed over.
"""

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from fem.band import Member
from fem.program import program_identity
from fem.run_folder import to_json, write_atomically


def read_members(path: Path, case_hash: str) -> list[Member]:
    """The finished members in a file; none where it is missing, damaged, or of another case or program."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        if (found["case_hash"], found["program"]) != (case_hash, program_identity()):
            return []
        return [Member(**member) for member in found["members"]]
    except (OSError, ValueError, KeyError, TypeError):
        return []


def write_members(path: Path, case_hash: str, members: Sequence[Member]) -> None:
    """Replace the file.

    Raises:
        OSError: it cannot be written; the old one is still there.
    """
    page = {
        "case_hash": case_hash,
        "program": program_identity(),
        "members": [asdict(one) for one in members],
    }
    write_atomically(path, to_json(page))
