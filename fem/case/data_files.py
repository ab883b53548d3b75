"""The files that a case names: where they are, which of them may lie outside its folder, and their copies in results.

A case file may come from anywhere, so that a file it names must lie in its folder or below it. What its user names on
the command line may lie anywhere. A motion may name a channel of its file behind "#", by number or name.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from fem.case.tables.problem import stays_in_the_folder
from fem.case.validation import CaseError
from fem.runtime.user_files import leads_out, real_path

#: keys that name files
FILE_KEYS = ("container.mesh_file", "motion.file", "vertical.file", "neighbour.case")
COPIES = "data"  #: folder in the results of the files that lie outside the folder of the case
WAYS_OUT = "; `run` and `check` take one from anywhere that the command line names, or with --allow-outside"


@dataclass(frozen=True, kw_only=True)
class DataFile:
    """A file that a case names."""

    path: Path
    channel: str  #: of a motion; empty where none is named
    copy: PurePosixPath  #: its place in the folder of results


def split_channel(folder: Path, name: str) -> tuple[Path, str]:
    """The file that a name means, and the channel behind "#"; a file that has "#" in its own name is found, too."""

    def path_of(name: str) -> Path:
        path = folder / name
        # A path of Windows, where it is no name of a file here.
        return path if "\\" not in name or path.exists() else folder / name.replace("\\", "/")

    whole = path_of(name)
    stem, mark, channel = name.rpartition("#")
    if not mark or not stem or whole.is_file():
        return whole, ""
    return path_of(stem), channel


def find_data_files(
    folder: Path, named: Mapping[str, str | None], *, trusted: frozenset[str]
) -> dict[str, DataFile]:
    """The files of a case by their keys; CaseError: a file is missing, or outside that folder and not to be trusted.

    Args:
        folder: of the case file.
        named: names as the case has them; a None names no file.
        trusted: keys whose files may lie outside that folder.
    """
    files: dict[str, DataFile] = {}
    for key, name in named.items():
        if name is None:
            continue
        path, channel = split_channel(folder, name)
        if key not in trusted and leads_out(folder, path):
            raise CaseError(
                f"{place_of(key)}must lie in the folder of the case file, got {name!r}, which leads to "
                f"{real_path(path)}; copy the file there{WAYS_OUT}"
            )
        if not path.is_file():
            what = ""
            if path.exists():
                what = ", which is a folder" if path.is_dir() else ", which is a device or a pipe"
            elif not Path(name).is_absolute():
                what = f", looked for in {real_path(folder)}; its path is relative to the case file"
            raise CaseError(f"{place_of(key)}names no file: {name!r}{what}")
        plain = copied_name(folder, name)
        copy = PurePosixPath(plain[: -len(channel) - 1] if channel else plain)
        for other, file in files.items():
            if file.copy == copy and real_path(file.path) != real_path(path):
                raise CaseError(
                    f"{place_of('vertical.file')}has the name of the file of {other}, {copy.name!r}, and another "
                    "folder; rename one of them"
                )
        files[key] = DataFile(path=path, channel=channel, copy=copy)
    return files


def copied_name(folder: Path, name: str) -> str:
    """The name of a file as a resolved case has it, which lies beside the copies."""
    if stays_in_the_folder(name):
        return name
    path, channel = split_channel(folder, name)
    return f"{COPIES}/{path.name}" + (f"#{channel}" if channel else "")


def place_of(dotted: str) -> str:
    """A key as messages begin."""
    table, _, key = dotted.partition(".")
    return f"[{table}] {key} "


def as_named_from(folder: Path, name: str) -> str:
    """A file named on the command line, relative to the current folder, as a case in a folder names it."""
    path = Path(name).absolute()
    if not leads_out(folder, path) and ".." not in Path(name).parts:
        return real_path(path).relative_to(real_path(folder)).as_posix()
    return str(path)
