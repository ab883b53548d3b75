"""`schema`: the JSON schema of the case file."""

import json

from fem.case.case import Case


def schema() -> None:
    """Print the JSON schema of the case file: keys, types, units, ranges, defaults."""
    print(json.dumps(Case.model_json_schema(by_alias=True), indent=2))
