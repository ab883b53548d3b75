"""The command line, `python -m fem`.

Commands are loaded by name when they are called, so that help and bad input answer at once. This is the
one place where errors of the user become a message and an exit code: 0 finished (overturned is a
result), 2 bad input, 3 the solution failed, 4 interrupted.
"""

import difflib
import errno
import os
import sys
from collections.abc import Sequence
from importlib import metadata
from typing import NoReturn

from cyclopts import App, CycloptsError

from fem.runtime.signals import INTERRUPTED, raise_on_signal
from fem.runtime.threads import use_one_blas_thread

BAD_INPUT, FAILED = 2, 3
NO_ROOM = {errno.ENOSPC, errno.EDQUOT, errno.EFBIG}
OWN_PACKAGES = {"fem", "mesh", "contact"}

FLAGS = ("--help", "-h", "--version")
COMMANDS = {
    "run": ("fem.cli.run:run", "Compute a case: rest, slide, rock, slide-rock or overturn."),
    "check": ("fem.cli.check:check", "Static checks, derived numbers and chosen numerics; no solution."),
    "init": ("fem.cli.init:init", "Write a commented case, sweep or ensemble file to start from."),
    "list": (
        "fem.cli.list_cases:list_cases",
        "The shipped cases, sweeps and ensembles, and what each shows.",
    ),
    "modes": ("fem.cli.modes:modes", "Elastic frequencies and shapes of the free container."),
    "sweep": (
        "fem.cli.sweep:sweep",
        "Compute many cases, over ranges of some keys.",
    ),
    "report": ("fem.cli.report:report", "One self-contained page from a run, a sweep or a study."),
    "ensemble": (
        "fem.cli.ensemble:ensemble",
        "Probability of overturning: fragility curve, or boundary over two axes.",
    ),
    "response": (
        "fem.cli.response:response",
        "Long-time motion, the frequency of the drive swept up and down.",
    ),
    "verify": ("fem.cli.verify:verify", "The verification ladder: every case with its reference."),
    "study": ("fem.cli.study:study", "Every statement of the seed paper, tried by runs."),
    "picture": ("fem.cli.picture:picture", "One instant of a run as a picture."),
    "movie": ("fem.cli.movie:movie", "A run as a film."),
    "doctor": (
        "fem.cli.doctor:doctor",
        "Versions, pictures, threads, disk; how to mend what is missing.",
    ),
    "schema": ("fem.cli.schema:schema", "JSON schema of the case file."),
}


def build_app() -> App:
    """The command line with its commands, none of them loaded."""
    app = App(
        name="python -m fem",
        help="Does an unanchored container rest, slide, rock or overturn when the floor moves?",
        help_format="plaintext",
        version=lambda: metadata.version("unanchored"),
        result_action="return_value",
        suppress_keyboard_interrupt=False,  # it would end the process with a code of its own
    )
    for name, (place, help_line) in COMMANDS.items():
        app.command(place, name=name, help=help_line)
    return app


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code.

    Args:
        arguments: what stands behind `python -m fem`; None takes it from the process.
    """
    use_one_blas_thread()
    tokens = list(sys.argv[1:] if arguments is None else arguments)
    if tokens and tokens[0] not in COMMANDS and tokens[0] not in FLAGS:
        return _refuse(_unknown_command(tokens[0]))
    try:
        result = build_app()(tokens, exit_on_error=False, print_error=False)
        sys.stdout.flush()
    except CycloptsError as error:
        command = f"{tokens[0]} " if tokens and tokens[0] in COMMANDS else ""
        return _refuse(f"{error}\nsee python -m fem {command}--help")
    except KeyboardInterrupt:
        print("interrupted", file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        # The reader has seen enough; Python would complain once more when it flushes at exit.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except OSError as error:
        code = FAILED if error.errno in NO_ROOM else BAD_INPUT
        return _refuse(f"{error.filename or 'input or output'}: {error.strerror or error}", code)
    except Exception as error:
        if type(error).__module__.partition(".")[0] not in OWN_PACKAGES:
            raise  # not the user's fault: show where
        return _refuse(str(error), getattr(error, "exit_code", BAD_INPUT))
    return result if isinstance(result, int) else 0


def _unknown_command(name: str) -> str:
    near = difflib.get_close_matches(name, COMMANDS, n=1)
    way_out = f"; did you mean {near[0]!r}?" if near else ""
    return f"no command {name!r}{way_out} (known: {', '.join(COMMANDS)})"


def _refuse(message: str, exit_code: int = BAD_INPUT) -> int:
    sys.stdout.flush()
    print(message.strip(), file=sys.stderr)
    return exit_code


def program() -> NoReturn:
    """The command line as a process of its own, which ends with the exit code of `main`.

    Before 3.12, Python ends itself by SIGINT instead where an interrupt has once come through `exec` of a text, as in
    an import that makes a named tuple, however it was caught.
    """
    raise_on_signal()
    code = main()
    if code == INTERRUPTED:
        os._exit(code)  # both streams are flushed
    sys.exit(code)


if __name__ == "__main__":
    program()
