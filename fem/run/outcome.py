"""A run of a rigid or reduced model of which only the verdict is wanted, as of most members of a band and of all maps.

The compiled stepping runs to the end without a history (`contact.stepping.outcome`), at less than the cost of a run
with samples, and finds the same verdict.
"""

import numpy as np

from contact.stepping.integrator import FAILED
from contact.stepping.links import LinkedBody
from contact.stepping.loose_stack import LooseStack
from contact.stepping.modal_body import ModalBody
from contact.stepping.outcome import run_to_end
from fem.assessment.verdict import audit, end_of_drive, verdict_from
from fem.model.model import Model
from fem.model.recovery import Recovery
from fem.results.run_result import Verdict
from fem.run.simulation import AFTERMATH, stepping_failure


def run_without_history(model: Model, recovery: Recovery | None) -> tuple[Verdict, str | None]:
    """Step a rigid or reduced model to its end, in place.

    Args:
        model: at t = 0.
        recovery: of the stresses of its container; None leaves them out.

    Returns:
        Its verdict, and why it failed, if it did: a verdict that does not count then.
    """
    assert isinstance(model.body, ModalBody | LooseStack | LinkedBody)
    run, duration, until = model.run, model.duration, end_of_drive(model)
    if model.case.output.stop_when_still:  # its samples and contents are not wanted
        history = run.buffers.history
        samples = history._replace(columns=history.columns[:, :0].copy())
        run = run._replace(buffers=run.buffers._replace(history=samples))
    if recovery is None:  # nobody looks at the steps that strain it most
        run = run._replace(strained=run.strained[:, :0].copy())
    status, kept = run_to_end(
        model.body,
        run,
        duration,
        rest_from=model.rest_from,
        aftermath=AFTERMATH / run.problem.control.slowest_rocking,
        slip_until=until,
        cycle=min(model.case.motion.period, duration),
    )
    interval = run.buffers.history.interval
    count = int(run.clock[0].samples)
    last = min(count - 1, int((until + 1e-9) / interval))
    numbers = np.arange(max(0, last + 1 - kept.slip.size), last + 1)
    stress = None if recovery is None else recovery.largest_of_steps(run.strained)
    end = (count - 1) * interval if count else None
    verdict = verdict_from(model, end, numbers * interval, kept.slip[numbers % kept.slip.size], stress)
    if status == FAILED:
        return verdict, stepping_failure(model, float(np.abs(run.work.law - run.work.force).max()))
    return verdict, audit(model)
