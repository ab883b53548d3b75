"""The ensembles that come with the program."""

from importlib import resources

SHIPPED_ENSEMBLES = tuple(
    sorted(
        entry.name[:-5]
        for entry in resources.files("fem.ensembles").iterdir()
        if entry.name.endswith(".toml")
    )
)


def shipped_ensemble_text(name: str) -> str:
    """The commented file of a shipped ensemble."""
    return (resources.files("fem.ensembles") / f"{name}.toml").read_text(encoding="utf-8")


def shipped_ensemble_description(name: str) -> str:
    """What a shipped ensemble shows: the first line of its file."""
    return shipped_ensemble_text(name).partition("\n")[0].lstrip("# ").strip()
