"""Names that other rooms still import from here."""

from fem.results.errors import FolderError, OutputError
from fem.results.errors import writing_into as naming_what_cannot_be_written
from fem.results.files import to_json, write_atomically
from fem.results.kinds import RUN, read_result
from fem.results.run_files import RunFiles as RunFolder
from fem.results.run_files import copy_data_files

FINISHED = RUN.finished
__all__ = [
    "FINISHED",
    "FolderError",
    "OutputError",
    "RunFolder",
    "copy_data_files",
    "naming_what_cannot_be_written",
    "read_result",
    "to_json",
    "write_atomically",
]
