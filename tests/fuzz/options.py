"""Commands with options and values of their own, as the command line itself declares them.

Only what a command would compute for long is bounded: the case is a small one, a study, a ladder and a sweep are not
begun, and nothing is written outside the folder of the input.
"""

from typing import Any

from data_inputs import CASE
from hypothesis import strategies as st
from inputs import NASTY, Input

from fem.__main__ import COMMANDS, build_app

Draw = Any
SHAKEN = CASE.format(motion='kind = "harmonic"\namplitude_m = 0.05\nangular_frequency_rad_s = 7.0\n')
SHAKEN = SHAKEN.replace("fields_s = 0.0\nfigures = false", "fields_s = 0.1")  # all that a run may write
#: commands that would begin something long whatever they are told
LONG = {"study", "verify", "ensemble", "sweep", "response"}
#: commands that read a folder of results
READERS = {"report", "picture", "movie"}
PLACES = ("out", "a/b/c", "case.toml", "", ".", "x" * 300, "out\u00e9", "/dev/null/x", "/proc/x", "a\nb")
FIRST = ("case.toml", "no.toml", "out", ".", "", "seed_bx", "case.toml/x", "-", "--", "\u0000")
VALUES = (*NASTY, "2", "0.5", "--json", "-q", "name")
SETTINGS = ("container.width_m=1", "container=1", "x.y=1", "=", "solver.model=reduced", "title=[")
SETTINGS += ("solver.duration_s=nan",)
USED = [name for name in COMMANDS if name not in LONG | READERS]
OPTIONS = {name: list(build_app()[name].assemble_argument_collection()) for name in USED}
#: options whose value is a place
PLACED = {"--out", "--to"}


@st.composite
def options(draw: Draw) -> Input:
    """A command with up to four of its options, each with a value or without one."""
    name = draw(st.sampled_from(sorted(OPTIONS)))
    usual = {"list": [], "schema": [], "doctor": []}.get(name, ["case.toml"])
    first = st.lists(st.sampled_from(FIRST), min_size=1, max_size=2)
    words = [name, *draw(st.just(usual) | st.just(usual) | first)]
    named = [argument for argument in OPTIONS[name] if argument.names[0].startswith("-")]
    for _ in range(draw(st.integers(0, 4)) if named else 0):
        argument = draw(st.sampled_from(named))
        option = draw(st.sampled_from(argument.names))
        misspelt = st.sampled_from((option[:-1], option + "x", option.upper()))
        words.append(draw(misspelt) if draw(st.integers(0, 15)) == 0 else option)
        if option in PLACED:
            words.append(draw(st.sampled_from(PLACES)))
        elif (argument.hint in (bool, bool | None)) == (draw(st.integers(0, 15)) == 0):
            words.append(draw(st.sampled_from(SETTINGS if option == "--set" else VALUES)))
    return Input(arguments=tuple(words), files={"case.toml": SHAKEN.encode()})
