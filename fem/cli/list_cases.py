"""`list`: the shipped cases, sweeps, ensembles and sites."""

import json
from textwrap import fill

from fem.case.files import COLLECTIONS, COMMANDS, DEFAULT_CASE
from fem.cli.console import WIDTH, AsJson
from fem.runtime.terminal import say


def list_cases(*, as_json: AsJson = False) -> None:
    """List the shipped cases, sweeps, ensembles and sites, each with its description."""
    if as_json:
        document = {
            f"{collection.kind}s": [
                {"name": name, "description": collection.description(name)} for name in collection.names
            ]
            for collection in COLLECTIONS
        }
        say(json.dumps({"default": DEFAULT_CASE} | document, indent=2))
        return
    width = max(len(name) for collection in COLLECTIONS for name in collection.names)
    for collection in COLLECTIONS:
        say(f"{collection.kind.capitalize()}s: python -m fem {COMMANDS[collection.kind]} NAME")
        for name in collection.names:
            mark = " (default)" if name == DEFAULT_CASE else ""
            text = f"{name:{width}}  {collection.description(name)}{mark}"
            say(fill(text, WIDTH, subsequent_indent=" " * (width + 2)))
        say()
    say("python -m fem init NAME writes any of them to a file.")
