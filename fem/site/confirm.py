"""The deciding runs, repeated with the reduced model over their unknown inputs."""

from collections.abc import Mapping
from dataclasses import replace

from fem.assessment.ranges import largest_bolt_forces
from fem.batch.compute_many import compute_many
from fem.results.figures import SLIPPED, TURNED, Place
from fem.results.outcome import ENDINGS
from fem.results.run_result import Band
from fem.site.result import SET, ConfirmedRun, RunKey, SiteRun
from fem.site.runs import RunCases

MODEL = "reduced"
MOST_DECIDING = 2  #: runs


def deciding(runs: Mapping[RunKey, SiteRun], governing: SiteRun | None) -> list[RunKey]:
    """The runs that decide: one that overturned, else that of the largest rotation; and that of the largest slip."""
    own = {key: run for key, run in runs.items() if key.stage == SET and run.outcome is not None}
    if governing is None or not own:
        return []
    stood = {key: run for key, run in own.items() if run.outcome not in ENDINGS}
    keys = [next(key for key, run in own.items() if run is governing)] if len(stood) < len(own) else []
    figures = (TURNED, SLIPPED)[len(keys) :] if stood else ()
    keys += [max(stood, key=lambda key: stood[key][figure] or 0.0) for figure in figures]
    return list(dict.fromkeys(keys))


def confirmed(
    cases: RunCases, runs: Mapping[RunKey, SiteRun], keys: list[RunKey], jobs: int | None
) -> list[ConfirmedRun]:
    """These runs with the reduced model, each with its band unless it rests far below the static limits.

    None where a signal stops them; the caller asks that.

    Raises:
        CaseError, MeshError: one of them cannot be computed.
    """
    results: list[ConfirmedRun] = []
    try:
        repeated = [cases(replace(key, model=MODEL)) for key in keys]
        again = compute_many(repeated, jobs, margin=False, inner_forces=False)
    except KeyboardInterrupt:
        return results
    for key, run in zip(keys, again, strict=True):
        verdict, joints = run.verdict, run.typed_result.joints or ()
        band = verdict.band or Band()
        tension, shear = largest_bolt_forces(joints) if joints else (None, None)
        used = [joint.bolt_utilisation for joint in joints if joint.bolt_utilisation is not None]
        results.append(
            ConfirmedRun(
                run=runs[key],
                model=MODEL,
                outcome=verdict.outcome,
                **verdict.figures(Place.KEY),
                bolt_tension_N=tension,
                bolt_shear_N=shear,
                bolt_utilisation=max(used, default=None),
                sure=verdict.sure or "",
                outcomes=band.outcomes,
                rotation_ratio_range=band.rotation_ratio or (),
                max_slip_m_range=band.max_slip_m or (),
            )
        )
    return results
