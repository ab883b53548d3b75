"""`schema`: the JSON schema of a case, sweep, ensemble or site file."""

import importlib
import json
from typing import Annotated, Literal

from cyclopts import Parameter

from fem.case.case import Case
from fem.runtime.terminal import say


def schema(
    kind: Annotated[Literal["case", "sweep", "ensemble", "site"], Parameter(help="Kind of file.")] = "case", /
) -> None:
    """Print the JSON schema of a kind of file: keys, types, units, ranges, defaults."""
    # The models of the other kinds take long to load.
    models = {} if kind == "case" else importlib.import_module("fem.cli.file_models").FILE_MODELS
    say(json.dumps(models.get(kind, Case).model_json_schema(by_alias=True), indent=2))
