"""Places of the files of a run in its folder."""

from collections.abc import Iterable
from pathlib import Path, PurePath

from fem.case.case import Case, CaseError
from fem.case.data_files import place_of
from fem.case.recorded import recorded_motion
from fem.records.columns import written
from fem.results.kinds import ResultKind
from fem.runtime.own_files import copy_file, place_in, write_atomically
from fem.runtime.user_files import real_path


class RunFiles:
    """Paths of the files of a run."""

    def __init__(self, path: Path) -> None:
        self.path = path  #: of the folder itself
        self.case = path / "case.toml"  #: as given
        self.resolved = path / "resolved.toml"  #: with every default written out
        self.result = path / "run.json"  #: status, verdict, static checks, energy, numerics
        self.summary = path / "summary.txt"  #: printed at the end of the run
        self.history = path / "history.csv"  #: one row a sample
        self.rigid_check = path / "rigid_check.csv"  #: the analytic block's rotation beside the run's
        self.fields = path / "fields"  #: folder of `run.pvd` and its frames
        self.figures = path / "figures"  #: folder of the figures
        self.drawn = self.figures / "drawn.json"  #: what the figures were drawn from
        self.report = path / "report.html"  #: unless it was asked for elsewhere
        self.checkpoint = path / "checkpoint.npz"  #: of an unfinished run
        self.band = path / "band.json"  #: finished members of an unfinished band


def require_free_names(case: Case, kind: ResultKind, texts: Iterable[str] = ()) -> None:
    """Refuse a mesh or motion file whose copy in a folder of results would be taken for a result.

    `texts`: names of further files in the folder.

    Raises:
        CaseError: with the key and the name.
    """
    for key, file in case.files.items():
        require_free_name(place_of(key), file.copy, kind, texts)
    for name in case.texts:
        require_free_name(place_of("neighbour.case"), PurePath(name), kind, texts)


def require_free_name(prefix: str, name: PurePath, kind: ResultKind, texts: Iterable[str] = ()) -> None:
    """Refuse the file of one key, which the reason begins with; as `require_free_names`."""
    if name.parts[0] in {own.partition("/")[0] for own in (kind.mark, *kind.own, *texts)}:
        raise CaseError(
            f"{prefix}is named {str(name)!r}, like a result of the {kind.name}, which would replace it in the folder "
            "of results; rename the file"
        )


def copy_data_files(case: Case, folder: Path, *, read: bool = False) -> None:
    """Copy mesh and motion files and the cases of neighbours into a folder, named as the resolved case names them.

    `read`: its motions have been read, so they are motions.

    Raises:
        CaseError: a motion file holds no motion; results go to others, and may not carry what else it holds.
    """
    if case.recorded is not None:
        write_atomically(folder / case.recorded.name, written(case.recorded))
    for key, file in case.files.items():
        if key == "motion.file" and not read:
            recorded_motion(case, "motion")
        elif key == "vertical.file" and not read:
            recorded_motion(case, "vertical")
        path, target = file.path, place_in(folder, file.copy)
        if real_path(target) != real_path(path):
            copy_file(path, target)
    own = {
        real_path(case.folder / neighbour.case) for neighbour in case.neighbour if neighbour.case is not None
    }
    for name, text in case.texts.items():
        target = place_in(folder, name)
        if real_path(target) not in own:
            write_atomically(target, text)
