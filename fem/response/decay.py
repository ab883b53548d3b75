"""Whether a motion dies out without its drive: condition (b) of stability in Knoedel and Hrabowski, section 2.

The floor is stopped at a turning point, where that is no impulse.
"""

from contact.stepping.integrator import OVERTURNED, REACHED
from contact.stepping.observables import ROCKING
from contact.stepping.outcome import advance_compiled
from fem.assessment.verdict import audit
from fem.case.case import Case
from fem.model.container import Container
from fem.response.model import DrivenModel, stop_drive

#: at rest: for so long, in 1/p, it neither turned beyond the limit of a verdict nor slid
STILL = 2.0
STILL_SLIP = 1e-6  #: over the width, between two checks
LOOK = 0.02  #: between two checks, in 1/p
PATIENCE = 400.0  #: followed at most, in 1/p


Decay = tuple[str, float | None]  #: fate, and time [s]


def follow_decay(case: Case, container: Container, driven: DrivenModel) -> Decay:
    """Stop the floor at a section and follow the container until it is at rest or overturned.

    Returns:
        dies out | overturns | goes on | failed, and the time from the stop until then [s].
    """
    stopped = stop_drive(case, container, driven)
    run, control = stopped.run, stopped.run.problem.control
    clock, track, joint = run.clock[0], run.track[0], run.joints[0]
    look = LOOK / control.frequency_parameter
    moved_at, limit = 0.0, ROCKING * control.slenderness_angle
    while clock.time < PATIENCE / control.frequency_parameter:
        track.max_rotation, travelled = 0.0, float(joint.slip_travel)
        code = advance_compiled(stopped.body, run, float(clock.time) + look)
        clock.samples_drained = clock.samples
        if code == OVERTURNED:
            return "overturns", float(track.overturned_at)
        if code != REACHED:
            return "failed", None
        if track.max_rotation > limit or joint.slip_travel - travelled > STILL_SLIP * control.width:
            moved_at = float(clock.time)
        if clock.time - moved_at > STILL / control.frequency_parameter:
            return "failed" if audit(stopped.model) else "dies out", moved_at
    return "goes on", None
