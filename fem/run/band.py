"""The band: sensitivity of the outcome to contact stiffness and damping.

Restitution at an impact is a property of the support, and where the container's first elastic mode is not far above
the bounce on the contact, an impact excites vibration as well: how much depends on stiffness and damping, and with
friction even the regime of motion may. Neither is known of a floor within a factor of three. So the run is repeated
with the penalty divided and multiplied by three and with damping ratios 0.5 (the contact bounces a little) and 2 (it
does not). Where the outcomes differ, the verdict is unsure. A member that fails has no outcome and makes the verdict
unsure as well.
"""

import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from itertools import count, product

from fem.assessment.verdict import MODE_NAMES, verdict_of
from fem.case.case import Case
from fem.model.model import Model, build_model
from fem.model.validity import runs_in_memory
from fem.results.run_result import Band, BandMember, Verdict
from fem.run.band_checkpoint import BandCheckpoint
from fem.run.recorder import Recorder
from fem.run.simulation import simulate
from fem.runtime.threads import cores
from fem.solid.nodal_body import full_model_memory

PENALTY_FACTORS = (1.0 / 3.0, 1.0, 3.0)
DAMPING_RATIOS = (0.5, 2.0)
#: outcomes that depend on impacts, or may
DEPENDENT = frozenset({"rock", "slide-rock", "overturned"})
NO_SAMPLES_S = 1e4  #: interval of a history of which only the first row is taken

#: normal penalty [Pa/m] and damping ratio of a contact
Contact = tuple[float, float]


def wants_band(asked: bool | None, case: Case, verdict: Verdict) -> bool:
    """Whether a finished run is to have a band: as asked, else where its outcome depends on impacts.

    A run of the `full` model has one only when asked: it would take six times as long.
    """
    if asked is not None:
        return asked
    return case.solver.model != "full" and verdict.outcome in DEPENDENT


def band_of(
    model: Model, verdict: Verdict, *, stop: Callable[[], bool], checkpoint: BandCheckpoint
) -> Band | None:
    """Compute the members of a band side by side and sum them up.

    Args:
        model: of the run; the mesh and modes of its container serve every member.
        verdict: of the run, which is itself a member.
        stop: called in pauses; true ends the band.
        checkpoint: of the band, to resume from.

    Returns:
        The band, or None if it was stopped.

    Raises:
        OSError: a checkpoint could not be written; the other members have stopped then.
    """
    own = (model.penalty, model.case.contact.damping_ratio)
    others = _other_contacts(*own)
    found = {(one.normal_penalty_Pa_m, one.damping_ratio): one for one in checkpoint.read_members()}
    one_at_a_time, broken = threading.Lock(), threading.Event()

    def halted() -> bool:
        return stop() or broken.is_set()

    def member_of(number: int, contact: Contact) -> BandMember:
        if contact in found:
            return found[contact]
        if halted():
            return _without_outcome(contact, "interrupted")
        try:
            member = _run_member(model, number, contact, halted, checkpoint)
            with one_at_a_time:
                if member.status != "interrupted":
                    found[contact] = member
                    checkpoint.write_members(number, list(found.values()))
        except BaseException:
            broken.set()  # stops the other members
            raise
        return member

    workers = min(cores(), len(others))
    if model.case.solver.model == "full":
        workers = runs_in_memory(workers, full_model_memory(len(model.container.elements.nodes)))
    with ThreadPoolExecutor(max_workers=workers) as pool:
        members = list(pool.map(member_of, count(1), others))
    if any(member.status == "interrupted" for member in members):
        return None
    status = "overturned" if verdict.outcome == "overturned" else "completed"
    return summed_up([member_from(own, status, verdict), *members])


def summed_up(members: Sequence[BandMember]) -> Band:
    """The band of these members: outcomes from rest to overturned, range of rotation, doubt."""
    standing = [member for member in members if member.outcome is not None]
    found = {member.outcome for member in standing}
    ratios = [member.rotation_ratio for member in standing if member.rotation_ratio is not None]
    return Band(
        outcomes=tuple(name for name in MODE_NAMES.values() if name in found),
        rotation_ratio=(min(ratios), max(ratios)),
        unsure=len(found) > 1 or len(standing) < len(members),
        members=tuple(members),
    )


def member_from(contact: Contact, status: str, verdict: Verdict) -> BandMember:
    """The member with this contact."""
    return BandMember(
        normal_penalty_Pa_m=contact[0],
        damping_ratio=contact[1],
        status=status,
        outcome=verdict.outcome,
        rotation_ratio=verdict.rotation_ratio,
        max_slip_m=verdict.max_slip_m,
        residual_slip_m=verdict.residual_slip_m,
        max_uplift_m=verdict.max_uplift_m,
    )


def _other_contacts(penalty: float, damping_ratio: float) -> list[Contact]:
    """The contacts of all members but the run itself."""
    ratios = sorted({*DAMPING_RATIOS, damping_ratio})
    return [
        (factor * penalty, ratio)
        for factor, ratio in product(PENALTY_FACTORS, ratios)
        if (factor, ratio) != (1.0, damping_ratio)
    ]


def _run_member(
    run: Model, number: int, contact: Contact, stop: Callable[[], bool], checkpoint: BandCheckpoint
) -> BandMember:
    """One member; a problem of any kind is its error, never an outcome."""
    try:
        case = run.case.with_values(
            {
                "contact.normal_penalty_Pa_m": contact[0],
                "contact.damping_ratio": contact[1],
                "output.history_s": NO_SAMPLES_S,
                "output.fields_s": 0.0,
            }
        )
        model = build_model(case, run.container)
        recorder = Recorder(model)
        save, progress = checkpoint.open_member(number, model, recorder)
        ending = simulate(model, recorder, stop=stop, save=save, progress=progress)
    # bad input, no equilibrium, a singular matrix
    except (ValueError, ArithmeticError, RuntimeError) as problem:
        return _without_outcome(contact, "failed", str(problem))
    if ending.status not in ("completed", "overturned"):
        return _without_outcome(contact, ending.status, ending.error)
    return member_from(contact, ending.status, verdict_of(model, recorder.history(), None))


def _without_outcome(contact: Contact, status: str, error: str | None = None) -> BandMember:
    return BandMember(normal_penalty_Pa_m=contact[0], damping_ratio=contact[1], status=status, error=error)
