"""The sweeps that come with the program."""

from importlib import resources

SHIPPED_SWEEPS = tuple(
    sorted(
        entry.name[:-5] for entry in resources.files("fem.sweeps").iterdir() if entry.name.endswith(".toml")
    )
)


def shipped_sweep_text(name: str) -> str:
    """The commented file of a shipped sweep."""
    return (resources.files("fem.sweeps") / f"{name}.toml").read_text(encoding="utf-8")


def shipped_sweep_description(name: str) -> str:
    """What a shipped sweep shows: the first line of its file."""
    return shipped_sweep_text(name).partition("\n")[0].lstrip("# ").strip()
