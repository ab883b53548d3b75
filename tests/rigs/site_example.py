"""A result of `assess` as its page shows it, without a run: container K1 on site S1, motions of shaped noise."""

import hashlib
import math
from dataclasses import replace
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
from running_example import SITE, k1

from fem.records.intensity import intensity
from fem.records.spectrum import response_spectrum
from fem.results.json_text import to_json
from fem.site.methods import site_methods
from fem.site.result import (
    MOTIONS,
    RESULT_FILE,
    ActionAnswer,
    ConfirmedRun,
    FloorResult,
    FurtherMotions,
    MotionSet,
    RuleRange,
    ScanPoint,
    SetCheck,
    SiteActionResult,
    SiteAnswer,
    SiteBody,
    SiteInputs,
    SiteMotion,
    SiteProvenance,
    SiteResult,
    SiteRun,
)

STEP = 0.01
PERIODS = np.geomspace(0.02, 4.0, 60)
INPUTS = SiteInputs(
    container="my-stack.toml",
    mu_static=(0.2, 0.4),
    mu_kinetic_over_static=(0.5, 1.0),
    rotation_ratio_limit=0.5,
    slip_limit_m=0.1,
    wind_pressure_Pa=650.0,
    wind_pressure_source="given",
    model="rigid",
)
RUN = SiteRun(
    motion=1,
    vertical_sign=1,
    mu_static=0.4,
    mu_kinetic=0.2,
    mass="full",
    model="rigid",
    outcome="rock",
    rotation_ratio=0.1,
    max_slip_m=0.01,
)


def noise(number: int, peak: float) -> np.ndarray:
    """A motion of 20 s with its energy about 1 s, of a given peak [m/s2]."""
    time = np.arange(0.0, 20.0 + 0.5 * STEP, STEP)
    random = np.random.default_rng(number)
    rates = np.geomspace(1.5, 120.0, 80)
    phases = random.uniform(0.0, 2.0 * math.pi, rates.size)
    wave = (np.sin(rates[:, None] * time + phases[:, None]) / rates[:, None] ** 0.3).sum(axis=0)
    wave *= np.clip(np.minimum(time / 2.0, (20.0 - time) / 6.0), 0.0, 1.0)
    return wave * peak / np.abs(wave).max()


@cache
def site_motion(number: int) -> tuple[SiteMotion, dict[str, str]]:
    """A motion of the set, and its files by name."""
    curves = {"h": noise(number, 2.5 + 0.05 * number), "v": noise(100 + number, 1.7)}
    time = np.arange(curves["h"].size) * STEP
    files = {
        f"{MOTIONS}/motion_{number:02d}_{letter}.csv": "time_s,acceleration_m_s2\n"
        + "".join(f"{one!r},{other!r}\n" for one, other in zip(time.tolist(), values.tolist(), strict=True))
        for letter, values in curves.items()
    }
    measures = intensity(time, curves["h"])
    spectra = [
        response_spectrum(STEP, values, PERIODS).pseudo_acceleration_m_s2 for values in curves.values()
    ]
    motion = SiteMotion(
        number=number,
        origin=f"seed {number}",
        pga_m_s2=measures.peak_acceleration_m_s2,
        pgv_m_s=measures.peak_velocity_m_s,
        pgd_m=measures.peak_displacement_m,
        d5_95_s=measures.significant_s,
        vertical_pga_m_s2=1.7,
        end_velocity_m_s=1e-8,
        end_displacement_m=2e-7,
        spectrum_m_s2=tuple(spectra[0].tolist()),
        vertical_spectrum_m_s2=tuple(spectra[1].tolist()),
        files=tuple(files),
        sha256=tuple(hashlib.sha256(text.encode()).hexdigest() for text in files.values()),
    )
    return motion, files


def site_body(mass: str) -> SiteBody:
    body = k1()
    block, share = body.block, 1.0 if mass == "full" else 0.16
    return SiteBody(
        mass=mass,
        elevation="width",
        mass_kg=share * body.mass,
        centroid_m=block.centroid_height,
        inertia_kg_m2=share * body.mass * block.radius**2 * (block.inertia_ratio - 1.0),
        support_width_m=2.0 * block.half_width,
        width_m=body.width,
        height_m=body.height,
        depth_m=body.depth,
        gravity_m_s2=block.gravity,
        slenderness_angle_rad=block.slenderness_angle,
        frequency_parameter_1_s=block.frequency_parameter,
        uplift_acceleration_m_s2=block.uplift_acceleration,
        housner_restitution=block.housner_restitution,
    )


def example(
    *, overturned: int = 0, valid: bool = True, building: bool = False
) -> tuple[SiteResult, dict[str, str]]:
    """A result, and the files of its motions; so many runs overturn, and the set may fail its checks."""
    motions, files = [], {}
    for number in range(1, 8):
        motion, texts = site_motion(number)
        motions.append(motion)
        files |= texts
    runs = tuple(
        replace(
            RUN,
            motion=motion.number,
            vertical_sign=sign,
            mu_static=mu,
            mu_kinetic=share * mu,
            mass=mass,
            building_period_s=period,
            outcome="slide" if mu == 0.2 else "rest",
            rotation_ratio=0.002 * motion.number,
            max_slip_m=0.003 * motion.number * (0.4 - mu) if mu == 0.2 else 1e-6,
        )
        for motion, sign, mu, share, mass, period in product(
            motions,
            (1, -1),
            (0.2, 0.4),
            (0.5, 1.0),
            ("full", "empty"),
            (0.425, 0.5, 0.575) if building else (None,),
        )
    )
    fell = [replace(run, outcome="overturned", rotation_ratio=2.0) for run in runs]
    runs = (*fell[:overturned], *runs[overturned:])
    mean = np.mean([motion.spectrum_m_s2 for motion in motions], axis=0)
    vertical_mean = np.mean([motion.vertical_spectrum_m_s2 for motion in motions], axis=0)
    target = SITE.horizontal(PERIODS)
    band = (PERIODS >= 0.05) & (PERIODS <= 4.0)
    worst = int(np.argmin(np.where(band, mean / target, np.inf)))
    least = float(mean[worst] / target[worst])
    bodies = (site_body("full"), site_body("empty"))
    action = SiteActionResult(
        source=SITE.shape.source,
        reference_acceleration_m_s2=SITE.reference_acceleration,
        importance_factor=1.0,
        element_importance_factor=1.0,
        ag_m_s2=SITE.ground_acceleration,
        soil_factor=1.35,
        ag_S_m_s2=SITE.surface_acceleration,
        avg_m_s2=SITE.vertical_acceleration,
        vertical_ratio=0.9,
        corner_periods_s=SITE.shape.corner_periods,
        vertical_corner_periods_s=SITE.shape.vertical_corner_periods,
        displacement_m=SITE.ground_displacement,
        periods_s=tuple(PERIODS.tolist()),
        target_m_s2=tuple(target.tolist()),
        mean_m_s2=tuple(mean.tolist()),
        vertical_target_m_s2=tuple(SITE.vertical(PERIODS).tolist()),
        vertical_mean_m_s2=tuple(vertical_mean.tolist()),
    )
    floor = FloorResult(
        z_over_h=1.0,
        building_periods_s=(0.425, 0.5, 0.575),
        damping_ratio=0.05,
        peak_m_s2=6.1,
        peak_velocity_m_s=0.8,
        mean_m_s2=tuple((mean * (1.0 + 3.0 * np.exp(-(np.log(PERIODS / 0.5) ** 2)))).tolist()),
    )
    mean_pga = float(np.mean([motion.pga_m_s2 for motion in motions]))
    clause = "EN 1998-1:2004, 3.2.3.1.2 (4) "
    band_in_words = f"least mean over target, 0.05 to 4 s, at {PERIODS[worst]:.3g} s"
    checks = tuple(
        SetCheck(name=name, found=found, demanded=demanded, unit=unit, fulfilled=fulfilled, clause=of)
        for name, found, demanded, unit, fulfilled, of in (
            ("number of motions", 7.0, "at least 3", "", True, f"{clause}a)"),
            ("mean of the zero-period values", mean_pga, "at least 2.4 m/s2", "m/s2", True, f"{clause}b)"),
            (band_in_words, least, "at least 0.9", "", valid, f"{clause}c)"),
            ("largest correlation of two motions", 0.12, "at most 0.3", "", True, ""),
        )
    )
    reasons = () if valid else (f"the mean spectrum is {least:.2f} of the target at {PERIODS[worst]:.3g} s",)
    fulfilled = None if not valid else overturned == 0
    governing = runs[0] if overturned else max(runs, key=lambda run: run.max_slip_m)
    answer = SiteAnswer(
        answer={None: None, True: "fulfilled", False: "not fulfilled"}[fulfilled],
        fulfilled=fulfilled,
        rule="mean over the 7 motions of the worse sign; any overturning means not fulfilled",
        sentence={
            None: "Not valid: the set of motions fails its checks.",
            True: "Fulfilled under the rule below: none of 112 runs overturned.",
            False: f"Not fulfilled under the rule below: {overturned} of 112 runs overturned.",
        }[fulfilled],
        overturned=overturned,
        runs=len(runs) if valid else 0,
        rotation_ratio=0.008,
        rotation_ratio_largest=0.014,
        slip_m=0.0042,
        slip_mean_m=0.0024,
        governing=governing,
        actions=(
            ActionAnswer(name="earthquake", answer="fulfilled" if fulfilled else None, utilisation=0.042),
            ActionAnswer(name="wind", answer="fulfilled", utilisation=0.254),
        ),
        margin_factor=1.625,
        factor_at_first_overturning=1.75,
        factor_at_first_movement=0.98,
        rule_range=RuleRange(
            rotation_ratio=(0.006, 0.011),
            rotation_ratio_largest=(0.012, 0.016),
            slip_m=(0.0042, 0.0043),
            repetitions=5,
        ),
        scan=tuple(
            ScanPoint(
                factor=f,
                runs=112,
                overturned=fallen,
                rotation_ratio=None if fallen else ratio,
                slip_m=0.0024 * f**3,
            )
            for f, ratio, fallen in zip(
                (0.5, 1.0, 1.5, 1.75, 2.0, 2.5, 4.0),
                (0.0, 0.008, 0.25, 0.5, 0.7, 0.8, 1.0),
                (0, 0, 0, 3, 0, 20, 70),
                strict=True,
            )
        ),
        further=(
            FurtherMotions(
                mass="full",
                mu_static=0.4,
                mu_kinetic=0.2,
                motions=100,
                overturned=0,
                beyond_limits=2,
                interval=(0.0, 0.0362),
            ),
        ),
        confirmed=(
            ConfirmedRun(
                run=governing,
                model="reduced",
                outcome="slide",
                rotation_ratio=0.004,
                max_slip_m=0.0041,
                sure="sure",
                outcomes=("slide",),
            ),
        ),
    )
    result = SiteResult(
        status="completed",
        title="Mercury containers <hall 3>",
        inputs=INPUTS,
        action=action,
        floor=floor if building else None,
        set=MotionSet(
            source="artificial",
            count=7,
            seed=1,
            stationary_s=12.0,
            band_s=(0.05, 4.0),
            mean_pga_m_s2=mean_pga,
            least_ratio=least,
            least_ratio_period_s=float(PERIODS[worst]),
            largest_correlation=0.12,
            valid=valid,
            reasons=reasons,
            checks=checks,
            motions=tuple(motions),
        ),
        bodies=bodies,
        runs=runs if valid else (),
        result=answer,
        methods=site_methods(
            bodies=bodies,
            inputs=INPUTS,
            site=SITE,
            motions=motions,
            periods_s=action.periods_s,
            floor=floor if building else None,
            runs=runs if valid else (),
        ),
        provenance=SiteProvenance(
            command="python -m fem assess site.toml",
            site_hash="a" * 64,
            case_hash="b" * 64,
            versions=(("unanchored", "0.1.0"), ("numpy", "2.3.1")),
            wall_s=21.3,
            cpu_s=38.2,
        ),
    )
    return result, files


def write_example(folder: Path, **changes) -> SiteResult:
    """The folder of such a result."""
    result, files = example(**changes)
    (folder / MOTIONS).mkdir(parents=True)
    for name, text in files.items():
        (folder / name).write_text(text, encoding="utf-8")
    (folder / RESULT_FILE).write_text(to_json(result.to_json() | {"asked": "ab" * 32}), encoding="utf-8")
    (folder / "site.toml").write_text('schema = 1\ncontainer = "my-stack.toml"\n', encoding="utf-8")
    (folder / "container.toml").write_text("schema = 1\n[container]\nwidth_m = 1.1\n", encoding="utf-8")
    return result
