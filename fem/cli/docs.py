"""`docs`: the documents that are installed with the program."""

from importlib.util import find_spec
from pathlib import Path

from fem.results.errors import FolderError

#: the packages whose folders hold a README for each room
PACKAGES = ("fem", "mesh", "contact")
NAME = "README.md"


def docs(room: str = "", /) -> None:
    """Print where the documents are, one for each room of the program, or the text of one.

    Parameters
    ----------
    room:
        Of which to print the text, such as case or contact.
    """
    places = found()
    if not room:
        for name, path in places.items():
            title = path.read_text(encoding="utf-8").partition("\n")[0].lstrip("# ")
            print(f"{name:<12}{title}\n{'':12}{path}")
        print("\npython -m fem docs NAME prints one of them.")
        return
    if room not in places:
        raise FolderError(f"docs {room}: no such document; there are {', '.join(places)}")
    print(places[room].read_text(encoding="utf-8"))


def found() -> dict[str, Path]:
    """The documents, by the names of their rooms."""
    places = {}
    for package in PACKAGES:
        spec = find_spec(package)
        for folder in (spec and spec.submodule_search_locations) or ():
            for path in sorted(Path(folder).rglob(NAME)):
                places[path.parent.name] = path
    return places
