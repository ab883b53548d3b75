"""The simplified methods for the container of a site, beside the results of the runs for the same action."""

from collections.abc import Sequence

import numpy as np

from contact.reference.rigid_block import RigidBlock
from contact.stepping.modes import ROCKING
from fem.case.validation import told_as
from fem.results.outcome import least_slide
from fem.runtime.units import finite
from fem.seismic.action import SiteAction
from fem.seismic.body import FloorAction, LooseBody, MethodQuantity, MethodRow, length_in_words
from fem.seismic.methods import methods_of, rows_with_factors
from fem.seismic.wind import wind_rows
from fem.site.answer import destroyed
from fem.site.result import FloorResult, SiteBody, SiteInputs, SiteMethod, SiteMotion, SiteRun
from fem.site.rule import groups_of, rule_of
from fem.site.tables import LimitsTable


def site_methods(
    *,
    bodies: Sequence[SiteBody],
    inputs: SiteInputs,
    limits: LimitsTable,
    site: SiteAction,
    motions: Sequence[SiteMotion],
    periods_s: Sequence[float],
    floor: FloorResult | None,
    runs: Sequence[SiteRun],
) -> tuple[SiteMethod, ...]:
    """Every method for every body, with the least friction, and for the lightest body the wind.

    Args:
        bodies: full and empty, in the elevations that were computed.
        site: on the ground.
        motions: of the set; their mean peak velocity is that of the action on the ground.
        periods_s: of the spectrum of the floor.
        floor: of the building; None: on the ground.
        runs: those of the set count, with both signs.
    """
    action = floor_action(site, motions, periods_s, floor)
    rows = []
    for body in bodies:
        loose = loose_body(body, inputs)
        methods = methods_of(
            loose,
            inputs.slip_limit_m,
            behaviour_factor=inputs.behaviour_factor,
            height_ratio=floor.z_over_h if floor else 0.0,
        )
        own = [run for run in runs if (run.mass, run.elevation) == (body.mass, body.elevation)]
        rows += [
            _result(
                row,
                body,
                found_by_runs(row, own, width=body.support_width_m, limits=limits),
                factor,
            )
            for row, factor in rows_with_factors(methods, action)
        ]
    lightest, under_wind = _under_wind(bodies, inputs)
    return (*rows, *(_result(row, lightest, ("no run: wind", ""), None) for row in under_wind))


def _under_wind(bodies: Sequence[SiteBody], inputs: SiteInputs) -> tuple[SiteBody, list[MethodRow]]:
    """The body with the least restoring moment, for which the wind is checked where it is asked for."""
    body, pressure = min(bodies, key=lambda one: one.mass_kg * one.support_width_m), inputs.wind_pressure_Pa
    if pressure is None:
        return body, []
    return body, wind_rows(loose_body(body, inputs), pressure, gamma_mu=inputs.gamma_mu)


def wind_utilisation(bodies: Sequence[SiteBody], inputs: SiteInputs) -> float | None:
    """The largest utilisation under wind; None where it was not asked for.

    Raises:
        CaseError: the container is higher than the rule for the wind holds.
    """
    with told_as("[wind] ", "; leave the table out"):
        _, rows = _under_wind(bodies, inputs)
    return max((row.utilisation for row in rows), default=None)


def loose_body(body: SiteBody, inputs: SiteInputs) -> LooseBody:
    """The body with the least friction of the range."""
    half, height, mu = 0.5 * body.support_width_m, body.centroid_m, min(inputs.mu_static)
    arm = body.mass_kg * (half**2 + height**2)
    return LooseBody(
        block=RigidBlock(
            half_width=half,
            centroid_height=height,
            gravity=body.gravity_m_s2,
            inertia_ratio=1.0 + body.inertia_kg_m2 / arm,
        ),
        width=body.width_m,
        height=body.height_m,
        depth=body.depth_m,
        mass=body.mass_kg,
        mu_static=mu,
        mu_kinetic=mu * min(inputs.mu_kinetic_over_static),
    )


def floor_action(
    site: SiteAction, motions: Sequence[SiteMotion], periods_s: Sequence[float], floor: FloorResult | None
) -> FloorAction:
    """The motion below the body: that of the site, or in a building the mean of the floor motions.

    The vertical motion is that of the ground, unless that of the floor is given.
    """
    velocity = sum(motion.pgv_m_s for motion in motions) / len(motions)
    ground = FloorAction.on_ground(site, velocity)
    if floor is None:
        return ground
    known, given = np.array([0.0, *periods_s]), floor.vertical_peak_m_s2
    values = np.array([floor.peak_m_s2, *floor.mean_m_s2])
    return FloorAction(
        peak=floor.peak_m_s2,
        vertical_peak=ground.vertical_peak if given is None else given,
        peak_velocity=floor.peak_velocity_m_s,
        spectrum=lambda periods: np.asarray(np.interp(periods, known, values)),
        ground_peak=ground.ground_peak,
        in_building=True,
    )


def found_by_runs(
    row: MethodRow, runs: Sequence[SiteRun], *, width: float, limits: LimitsTable
) -> tuple[str, str]:
    """What the rule finds in the runs of the set beside a method, and how the two compare, in words.

    Overturning: over all frictions; slip: with the least friction, as the methods take it. A method is conservative
    where it refuses what the rule fulfils, or tells more slip than the rule counts. Neither a median nor a method out
    of its range is compared.
    """
    done = [run for run in runs if run.stage == "set" and run.outcome is not None]
    if not done:
        return "no runs", ""
    overturns = row.quantity is MethodQuantity.OVERTURNING
    words, compared = _overturning(row, done, limits) if overturns else _sliding(row, done, width)
    return words, "" if row.median or row.beyond else compared


def _overturning(row: MethodRow, done: Sequence[SiteRun], limits: LimitsTable) -> tuple[str, str]:
    tally = rule_of(groups_of(done))
    words = f"{tally.overturned or 'none'} of {len(done)} overturned{destroyed(tally.invalid)}"
    turned, largest = tally.rotation_ratio, tally.rotation_ratio_largest
    if turned is not None and largest is not None:
        words += f"; by the rule {turned:.2g} of the angle" if largest > ROCKING else "; none rocks"
        if largest > ROCKING and largest > turned:
            words += f", at most {largest:.2g}"
    failed = tally.overturned + tally.invalid > 0 or bool({*tally.exceeded(limits)} - {"slip_m"})
    return words, _compared(refused=not row.fulfilled, failed=failed)


def _sliding(row: MethodRow, done: Sequence[SiteRun], width: float) -> tuple[str, str]:
    least = min((run.mu_static, run.mu_kinetic) for run in done)
    own = [run for run in done if (run.mu_static, run.mu_kinetic) == least]
    most = max(run.slipped for run in own)
    slides = most > least_slide(width)
    mean = rule_of(groups_of(own)).slip_mean_m
    words = f"largest {length_in_words(most)}" if slides else "none slides"
    if slides and mean is not None:
        words += f", mean {length_in_words(mean)}"
    if row.quantity is MethodQuantity.SLIDING:
        return words, _compared(refused=not row.fulfilled, failed=slides)
    within = min(row.demand, most) >= 0.9 * max(row.demand, most)
    return words, "agrees" if within else "conservative" if row.demand > most else "not conservative"


def _compared(*, refused: bool, failed: bool) -> str:
    if refused == failed:
        return "agrees"
    return "conservative" if refused else "not conservative"


def _result(row: MethodRow, body: SiteBody, found: tuple[str, str], factor: float | None) -> SiteMethod:
    return SiteMethod(
        **vars(row) | {"quantity": row.quantity.value, "demand": finite(row.demand)},
        mass=body.mass,
        elevation=body.elevation,
        utilisation=finite(row.utilisation),
        found=found[0],
        compared=found[1],
        factor=factor,
    )
