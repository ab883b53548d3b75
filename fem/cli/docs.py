"""`docs`: the documents that are installed with the program."""

from importlib import metadata
from importlib.util import find_spec
from pathlib import Path

from fem.results.errors import FolderError
from fem.runtime.terminal import say
from fem.runtime.user_files import read_text

START = "start"  #: the README of the project, which is part of its metadata wherever it is installed
#: the packages whose folders hold a README for each room, and further pages
PACKAGES = ("fem", "mesh", "contact")


def docs(room: str = "", /) -> None:
    """Print where the documents are, for each room of the program, or the text of one.

    Parameters
    ----------
    room:
        Of which to print the text, such as start, case, keys or contact.
    """
    places = found()
    if room == START:
        say(str(metadata.metadata("unanchored").get_payload()))
    elif not room:
        say(f"{START:<12}what the program answers, and the first five minutes")
        for name, path in places.items():
            title = read_text(path).partition("\n")[0].lstrip("# ")
            say(f"{name:<12}{title}\n{'':12}{path}")
        say("\npython -m fem docs NAME prints one of them.")
    elif room not in places:
        raise FolderError(f"docs {room}: no such document; there are {', '.join([START, *places])}")
    else:
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
