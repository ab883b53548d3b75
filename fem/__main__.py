"""The command line, `python -m fem` or `unanchored`.

Commands are loaded by name when they are called, so that help and bad input are answered at once. This is the one place
where errors of the user become a message and an exit code: 0 finished (overturned is a result), 2 bad input, 3 the
solution failed, 4 interrupted.
"""

import difflib
import errno
import gc
import io
import os
import re
import sys
from collections import defaultdict
from collections.abc import Sequence
from contextlib import suppress
from importlib import metadata
from typing import Literal, NoReturn

from cyclopts import App, CycloptsError, Group, MissingArgumentError, Parameter, UnusedCliTokensError
from cyclopts.exceptions import RepeatArgumentError

from fem.runtime.late_modules import LateFinder
from fem.runtime.left import left_words
from fem.runtime.memory import limit, memory_of, share_the_heap, shortage
from fem.runtime.signals import INTERRUPTED, NO_ANSWER, interruptions, raise_on_signal
from fem.runtime.terminal import one_line, say
from fem.runtime.threads import use_one_blas_thread

BAD_INPUT, FAILED = 2, 3
COLLECT_EVERY = 500_000  #: new objects; a run with its figures makes 400,000
NO_ROOM = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}
WORDS = defaultdict(lambda: "another value", float="a number", int="a whole number", bool="yes or no")
OWN_PACKAGES = {"fem", "mesh", "contact"}

FLAGS = ("--help", "-h", "--version")
#: options that contradict each other, beside `--NAME` and `--no-NAME`
CONTRARY = (("--resume", "--force"), ("--quiet", "--verbose"), ("--short", "--full"), ("--json", "--full"))
SHORT = {"q": "--quiet", "v": "--verbose"}
#: group -> command -> what it does, and arguments as an example
GROUPS = {
    "Commands": {
        "run": ("Compute a case: does it rest, slide, rock or overturn?", "my-stack.toml"),
        "check": ("Print static checks and settings of a case without computing it.", "my-stack.toml"),
        "report": ("Make one HTML page from a folder of results.", "outputs/my-stack"),
        "init": ("Write a commented case, sweep, ensemble or site file to start from.", "--to my-stack.toml"),
        "list": ("List the shipped cases, sweeps, ensembles and sites.", ""),
        "sweep": ("Compute a case over ranges of some keys, and map the outcome.", "outcome_map -j 4"),
        "batch": (
            "Compute a list of containers, and give it back with results.",
            "hall.csv --case my-stack.toml",
        ),
        "assess": ("Verify a container at a site by EN 1998-1, time histories and rules.", "site -j 4"),
    },
    "More": {
        "ensemble": ("Estimate the probability of overturning, parameters uncertain.", "fragility -j 4"),
        "size": (
            "Find the least width, tallest stack or strongest action that a site allows.",
            "site --over container.width_m",
        ),
        "explore": ("Make a page with a slider for each axis of a sweep, and its motions.", "explorer"),
        "response": ("Compute the long-time motion over the frequency of the floor.", "--shell"),
        "picture": (
            "Draw one instant of a run, or a motion and its spectrum (PNG).",
            "outputs/my-stack --time 3.2",
        ),
        "movie": ("Animate a run (GIF or MP4).", "outputs/my-stack --to rocking.gif"),
        "modes": ("Compute elastic frequencies and shapes of the free container.", "my-stack.toml"),
        "verify": ("Compare the program with reference solutions.", "--quick"),
        "validate": ("Predict laboratory experiments and compare with what was measured.", "--data motions"),
        "study": ("Check every claim of the paper (Knoedel and Hrabowski) by runs.", "seed -j 4"),
        "doctor": ("Report missing dependencies and how to install them.", ""),
        "docs": ("Print where the documents of the program are, or one of them.", "case"),
        "schema": ("Print the JSON schema of a case, sweep, ensemble or site file.", "sweep"),
        "completion": ("Print the completion script of a shell, for `unanchored`.", "bash"),
    },
}
COMMANDS = [name for commands in GROUPS.values() for name in commands]
#: commands that compute; `run` looks at its case before it asks for memory
COMPUTING = {*COMMANDS} - {"check", "init", "list", "completion", "schema", "docs", "doctor", "run"}
#: import strings of commands that are not `fem.cli.NAME:NAME`
PLACES = {"list": "fem.cli.shipped:list_cases", "completion": "fem.__main__:completion"}
PLACES |= {
    name: f"fem.cli.{module}:{name}"
    for module, names in {
        "check": "run",
        "picture": "movie",
        "shipped": "init schema docs doctor",
        "evidence": "verify validate study",
        "studies": "sweep batch assess ensemble size response explore",
    }.items()
    for name in names.split()
}


def _default_in_words(value: object) -> str | None:
    """What help shows of a default: numbers and names."""
    return None if value is None or value is False or value in ("", ()) else str(value)


def build_app(name: str = "python -m fem") -> App:
    """The command line with its commands, none of them loaded."""
    app = App(
        name=name,
        help="Does an unanchored container rest, slide, rock or overturn when the floor moves?\n\n"
        "`unanchored` is the same program as `python -m fem`. COMMAND --help gives an example.",
        help_format="plaintext",
        version=lambda: metadata.version("unanchored"),
        group_commands=Group("Options", sort_key=len(GROUPS)),
        default_parameter=Parameter(negative=(), show_default=_default_in_words),
        result_action="return_value",
        suppress_keyboard_interrupt=False,  # it would end the process with a code of its own
    )
    for number, (title, commands) in enumerate(GROUPS.items()):
        group = Group(title, sort_key=number)
        for order, (command, (help_line, example)) in enumerate(commands.items()):
            app.command(
                PLACES.get(command, f"fem.cli.{command}:{command}"),
                name=command,
                help=f"{help_line}\n\nExample: python -m fem {command} {example}".rstrip(),
                group=group,
                sort_key=order,
            )
    return app


def completion(shell: Literal["bash", "zsh", "fish"] = "bash", /) -> None:
    """Print the completion script of a shell for `unanchored`, the installed name of the program."""
    say(build_app("unanchored").generate_completion(shell=shell))


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code.

    Args:
        arguments: what stands behind `python -m fem`; None takes it from the process.
    """
    use_one_blas_thread()
    share_the_heap()
    before = interruptions()
    tokens = list(sys.argv[1:] if arguments is None else arguments)
    for token in tokens:
        if one_line(token) != token:
            return _refuse(f"{token!r} holds an end of line; give names and values in one line each")
    options = [token.partition("=")[0] for token in tokens[1:] if token.startswith("--")]
    for name in [*tokens[:1], *options, *(f"{tokens[0]} {option}" for option in options)]:
        if words := left_words(name):
            return _refuse(f"{name} {words}")
    letters = "".join(token[1:] for token in tokens[1:] if re.fullmatch("-[a-z]+", token))
    given = {*options, *(SHORT[letter] for letter in letters if letter in SHORT)}
    for pair in (*CONTRARY, *((f"--{name[5:]}", name) for name in options if name.startswith("--no-"))):
        if given.issuperset(pair):
            return _refuse(f"{' and '.join(pair)} contradict each other; give one of them")
    if tokens and tokens[0] not in COMMANDS and tokens[0] not in FLAGS:
        near = difflib.get_close_matches(tokens[0], COMMANDS, n=1)
        way_out = f"; did you mean {near[0]!r}?" if near else ""
        return _refuse(f"no command {tokens[0]!r}{way_out} (known: {', '.join(COMMANDS)})")
    if tokens and (short := shortage(memory_of(tokens[0] in COMPUTING, _jobs_of(tokens)))):
        return _refuse(short, FAILED)
    try:
        result = build_app()(tokens, exit_on_error=False, print_error=False)
        sys.stdout.flush()
    except CycloptsError as error:
        command = f"{tokens[0]} " if tokens and tokens[0] in COMMANDS else ""
        return _refuse(f"{_in_words(error)}\nsee python -m fem {command}--help")
    except KeyboardInterrupt:
        return _interrupted(tokens)
    except MemoryError:
        return _refuse(
            "out of memory; fewer jobs (-j 1), larger elements or the model rigid need less, and --resume continues",
            FAILED,
        )
    except BrokenPipeError:
        # The reader has seen enough; Python would complain once more when it flushes at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except SystemExit:  # so Rich, which prints help, tells the same
        return 0
    except OSError as error:
        code = FAILED if error.errno in NO_ROOM else BAD_INPUT
        return _refuse(
            f"{one_line(str(error.filename or 'input or output'))}: {error.strerror or error}", code
        )
    except Exception as error:
        if interruptions() > before:
            return _interrupted(tokens)
        if OWN_PACKAGES.isdisjoint(kind.__module__.partition(".")[0] for kind in type(error).__mro__):
            raise  # not the user's fault: show where
        return _refuse(str(error), getattr(error, "exit_code", BAD_INPUT))
    return result if isinstance(result, int) else 0


def _in_words(error: CycloptsError) -> str:
    """An error in the arguments, without the phrases of the library."""
    if isinstance(error, UnusedCliTokensError):
        return f"too many arguments: {' '.join(map(repr, error.unused_tokens or []))}"
    if isinstance(error, RepeatArgumentError):
        return f"{error.token.keyword} is given more than once; give it once"
    if isinstance(error, MissingArgumentError) and error.argument is not None:
        name = error.argument.name
        return f"{name} needs a value" if name.startswith("-") else f"{name} is missing"
    return re.sub(
        r'unable to convert (".*") into (\w+)\.',
        lambda match: f"{WORDS[match[2]]} is needed, not {match[1]}",
        str(error),
    )


def _jobs_of(tokens: Sequence[str]) -> int | None:
    """The cores that `-j` asks for; None where it does not."""
    for token, following in zip(tokens, [*tokens[1:], ""], strict=True):
        if (jobs := re.fullmatch(r"(?:-j|--jobs)=?(\d*)", token)) and (jobs[1] or following).isdigit():
            return int(jobs[1] or following)
    return None


def _interrupted(tokens: Sequence[str]) -> int:
    """End a command that could not say itself how far it came."""
    if "--json" in tokens:
        say(NO_ANSWER, end="")
    return _refuse("interrupted", INTERRUPTED)


def _refuse(message: str, exit_code: int = BAD_INPUT) -> int:
    sys.stdout.flush()
    with suppress(OSError):  # nobody can be told: the exit code remains
        say(message.strip(), file=sys.stderr, flush=True)
    return exit_code


def program() -> NoReturn:
    """The command line as a process of its own, which ends with the exit code of `main`.

    Before 3.12, Python ends itself by SIGINT instead where an interrupt has once come through `exec` of a text, as in
    an import that makes a named tuple, however it was caught.
    """
    raise_on_signal(watched=limit() is None)  # a thread takes 70 MB of address space
    sys.meta_path.insert(0, LateFinder)
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:  # closed
            setattr(sys, name, os.fdopen(os.open(os.devnull, os.O_WRONLY), "w"))
        elif isinstance(stream, io.TextIOWrapper):
            # its encoding may lack some signs, as of a pipe on Windows
            stream.reconfigure(errors="replace")
    # A pass of the cyclic collector for every 700 objects would be a fifth of a short run, most of it over the
    # modules that are being loaded.
    gc.set_threshold(COLLECT_EVERY)
    code = main()
    # At its end, Python searches all objects for cycles: a fifth of a short run. Frozen ones are left out.
    gc.freeze()
    if code == INTERRUPTED:
        os._exit(code)  # both streams are flushed
    sys.exit(code)


if __name__ == "__main__":
    program()
