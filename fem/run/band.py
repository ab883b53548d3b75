"""How sure an outcome is: the same run again over the stiffness and the damping of the contact.

Restitution at an impact is a property of the support, and where the container's first elastic mode is not far
above the bounce on the contact, an impact feeds vibration as well: how much then depends on stiffness and
damping, and with friction even the regime of motion may. Nobody knows either of a floor within a factor of
three. So the run is repeated with the penalty divided and multiplied by three and with damping ratios 0.5
(the contact bounces a little) and 2 (it does not); where the outcomes differ, the verdict is unsure. A member
that fails is no outcome and makes it unsure as well.
"""

import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import count, product
from typing import Protocol

from fem.assessment.verdict import MODE_NAMES, short_verdict
from fem.case.case import Case
from fem.model.container import Container
from fem.model.model import Model, build_model
from fem.model.required_memory import fitting_full_bodies
from fem.results.run_result import Band, BandMember, Verdict
from fem.run.recorder import Recorder
from fem.run.simulation import Keeper, NoKeeper, Progress, simulate
from fem.runtime.threads import cores

PENALTY_FACTORS = (1.0 / 3.0, 1.0, 3.0)
DAMPING_RATIOS = (0.5, 2.0)
#: outcomes that depend on impacts, or may
DEPENDENT = frozenset({"rock", "slide-rock", "overturned"})
NO_SAMPLES_S = 1e4  #: interval of a history of which nobody will read more than its first row


class Keeping(Protocol):
    """Somebody who may keep what a band has come to; called by several threads."""

    def members(self) -> Sequence[BandMember]:
        """Computed before: they are not computed again."""

    def begin(self, number: int, model: Model, recorder: Recorder) -> tuple[Keeper, Progress]:
        """A member begins: it is put where it was cut off; returns who keeps it from there, and how far it has come."""

    def finish(self, number: int, members: Sequence[BandMember]) -> None:
        """A member has ended; `members` are all that there are. Only one thread calls at a time."""


class NoKeeping:
    """Keeps nothing."""

    def members(self) -> Sequence[BandMember]:
        """None."""
        return ()

    def begin(self, number: int, model: Model, recorder: Recorder) -> tuple[Keeper, Progress]:
        """At t = 0."""
        return NoKeeper(), Progress()

    def finish(self, number: int, members: Sequence[BandMember]) -> None:
        """Nothing."""


def wants_band(asked: bool | None, case: Case, verdict: Verdict) -> bool:
    """Whether a finished run is to have a band: as asked, else where its outcome depends on impacts.

    A run of the `full` model has one only when asked: it would take six times as long.
    """
    if asked is not None:
        return asked
    return case.solver.model != "full" and verdict.outcome in DEPENDENT


def band_of(
    case: Case,
    container: Container,
    *,
    penalty: float,
    verdict: Verdict,
    stop: Callable[[], bool] = lambda: False,
    keeping: Keeping | None = None,
) -> Band | None:
    """Run the members of a band side by side and sum them up.

    Args:
        case: of the run.
        container: of the run; its mesh and modes serve every member.
        penalty: of the run [Pa/m].
        verdict: of the run, which is itself a member.
        stop: asked now and then; true ends the band.
        keeping: may keep what there is of it, to go on with.

    Returns:
        The `band` of a verdict, or None if it was stopped.

    Raises:
        OSError: something could not be kept; the other members have stopped then.
    """
    keeping = keeping or NoKeeping()
    given = member_from(
        (penalty, case.contact.damping_ratio),
        "overturned" if verdict.outcome == "overturned" else "completed",
        verdict,
    )
    floors = _other_floors(penalty, case.contact.damping_ratio)
    found = {(member.normal_penalty_Pa_m, member.damping_ratio): member for member in keeping.members()}
    one_at_a_time, broken = threading.Lock(), threading.Event()

    def halted() -> bool:
        return stop() or broken.is_set()

    def member_of(number: int, floor: tuple[float, float]) -> BandMember:
        if floor in found:
            return found[floor]
        if halted():
            return _without_outcome(floor, "interrupted")
        try:
            member = _run_member(
                case,
                container,
                floor,
                stop=halted,
                begin=lambda model, recorder: keeping.begin(number, model, recorder),
            )
            with one_at_a_time:
                if member.status != "interrupted":
                    found[floor] = member
                    keeping.finish(number, list(found.values()))
        except BaseException:
            broken.set()  # else the others would be waited for
            raise
        return member

    workers = min(cores(), len(floors))
    if case.solver.model == "full":
        workers = fitting_full_bodies(workers, len(container.elements.nodes))
    with ThreadPoolExecutor(max_workers=workers) as pool:
        members = list(pool.map(member_of, count(1), floors))
    if any(member.status == "interrupted" for member in members):
        return None
    return summed_up([given, *members])


def summed_up(members: Sequence[BandMember]) -> Band:
    """The `band` of a verdict: outcomes in the order of the motion's states, range of rotation, doubt."""
    standing = [member for member in members if member.outcome is not None]
    found = {member.outcome for member in standing}
    ratios = [member.rotation_ratio for member in standing if member.rotation_ratio is not None]
    return Band(
        outcomes=tuple(name for name in MODE_NAMES.values() if name in found),
        rotation_ratio=(min(ratios), max(ratios)),
        unsure=len(found) > 1 or len(standing) < len(members),
        members=tuple(members),
    )


def member_from(floor: tuple[float, float], status: str, verdict: Verdict) -> BandMember:
    """The member with this penalty [Pa/m] and damping ratio."""
    penalty, damping_ratio = floor
    return BandMember(
        normal_penalty_Pa_m=penalty,
        damping_ratio=damping_ratio,
        status=status,
        outcome=verdict.outcome,
        rotation_ratio=verdict.rotation_ratio,
        max_slip_m=verdict.max_slip_m,
        residual_slip_m=verdict.residual_slip_m,
        max_uplift_m=verdict.max_uplift_m,
    )


def _other_floors(penalty: float, damping_ratio: float) -> list[tuple[float, float]]:
    """Penalty [Pa/m] and damping ratio of all members but the run itself."""
    ratios = sorted({*DAMPING_RATIOS, damping_ratio})
    return [
        (factor * penalty, ratio)
        for factor, ratio in product(PENALTY_FACTORS, ratios)
        if (factor, ratio) != (1.0, damping_ratio)
    ]


def _run_member(
    case: Case,
    container: Container,
    floor: tuple[float, float],
    *,
    stop: Callable[[], bool],
    begin: Callable[[Model, Recorder], tuple[Keeper, Progress]],
) -> BandMember:
    """One member; whatever keeps it from an outcome is its error, never an outcome."""
    penalty, damping_ratio = floor
    try:
        changed = case.with_values(
            {
                "contact.normal_penalty_Pa_m": penalty,
                "contact.damping_ratio": damping_ratio,
                "output.history_s": NO_SAMPLES_S,
                "output.fields_s": 0.0,
            }
        )
        model = build_model(changed, container)
        recorder = Recorder(model)
        keeper, progress = begin(model, recorder)
        ending = simulate(model, recorder, stop=stop, keeper=keeper, progress=progress)
    except (ValueError, ArithmeticError, RuntimeError) as problem:  # bad input, no stance, a singular matrix
        return _without_outcome(floor, "failed", str(problem))
    if ending.status not in ("completed", "overturned"):
        return _without_outcome(floor, ending.status, ending.error)
    return member_from(floor, ending.status, short_verdict(model))


def _without_outcome(floor: tuple[float, float], status: str, error: str | None = None) -> BandMember:
    penalty, damping_ratio = floor
    return BandMember(
        normal_penalty_Pa_m=penalty,
        damping_ratio=damping_ratio,
        status=status,
        error=error,
    )
