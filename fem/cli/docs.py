"""`docs`: the documents that are installed with the program."""

from importlib.util import find_spec
from pathlib import Path

from fem.results.errors import FolderError
from fem.runtime.terminal import say
from fem.runtime.user_files import read_text

#: the packages whose folders hold a README for each room, and further pages
PACKAGES = ("fem", "mesh", "contact")


def docs(room: str = "", /) -> None:
    """Print where the documents are, for each room of the program, or the text of one.

    Parameters
    ----------
    room:
        Of which to print the text, such as case, keys or contact.
    """
    places = found()
    if not room:
        for name, path in places.items():
            title = read_text(path).partition("\n")[0].lstrip("# ")
            say(f"{name:<12}{title}\n{'':12}{path}")
        say("\npython -m fem docs NAME prints one of them.")
        return
    if room not in places:
        raise FolderError(f"docs {room}: no such document; there are {', '.join(places)}")
    say(read_text(places[room]))


def found() -> dict[str, Path]:
    """The documents, by the names of their rooms; further pages by their own."""
    places = {}
    for package in PACKAGES:
        spec = find_spec(package)
        for folder in (spec and spec.submodule_search_locations) or ():
            for path in sorted(Path(folder).rglob("*.md")):
                places[path.parent.name if path.stem == "README" else path.stem] = path
    return places
