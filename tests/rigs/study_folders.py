"""Folders of an ensemble and of a response curve as the commands leave them, of few points, without running them."""

import json
from pathlib import Path

from fem.case.case import load_case, to_toml

HERE = Path(__file__).parent
FIGURE = (
    '<svg xmlns="http://www.w3.org/2000/svg" width="100" height="50"><g><path d="M 0 0 L 9 9"/></g></svg>'
)


def ensemble_folder(folder: Path, **more: object) -> Path:
    """A fragility curve of three points: half of the draws overturn at 0.45 g."""
    texts = {"ensemble.toml": 'case = "<b>.toml"\n', "base.toml": to_toml(load_case())}
    return _write(folder, "ensemble", "fragility", texts, more)


def response_folder(folder: Path, **more: object) -> Path:
    """Two frequencies up and down; the upper one has two motions, the lower one overturns on the way down."""
    return _write(folder, "response", "response_curve", {"case.toml": to_toml(load_case())}, more)


def _write(folder: Path, kind: str, figure: str, texts: dict[str, str], more: dict[str, object]) -> Path:
    result = json.loads((HERE / f"{kind}_result.json").read_text(encoding="utf-8")) | more
    texts = texts | {f"{kind}.json": json.dumps(result), f"figures/{figure}.svg": FIGURE}
    for name, text in texts.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return folder
