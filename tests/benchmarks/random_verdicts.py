"""How often a verdict that is sure is turned over by ordinary changes of the case: random containers, floors, motions.

The motions are pulses, and harmonic ones and records with and without a vertical one. Each case is run with its band.
Of those that are sure, or stand or fall in all variations (regime unsure), further changes are run, which an engineer
would not call another case: friction, width, mass centre, strength of the motion, phase, duration, floor, the other
model. A verdict is wrong where one of them crosses between standing and overturning.

    python tests/benchmarks/random_verdicts.py --cases 200 --seed 7 --jobs 2
"""

import argparse
import sys
import time
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from typing import Any

import numpy as np
from motion_set import motion as random_motion

import fem
from fem.case.case import Case
from fem.case.strength import scaled_motion

MOST_WRONG, LEAST_DECIDED = 0.02, 0.4
Change = tuple[str, dict[str, Any]]


def random_case(generator: np.random.Generator) -> Case:
    """A container on any base and floor, under a motion of 0.9 to 3 times its static limit."""
    draw, pick = generator.uniform, generator.choice
    boxes, width = int(pick([1, 2, 3, 4])), float(draw(0.5, 2.5))
    height = float(draw(0.8, 2.5)) * width * (1.0 if boxes == 1 else 0.6)
    static = float(draw(0.25, 0.7))
    limit = 9.81 * min(static, 0.5 * width / (0.5 * boxes * height))
    peak = float(draw(0.9, 3.0)) * limit
    support = {"kind": str(pick(["corners", "feet", "flat"]))}
    if support["kind"] == "feet":
        support["foot_m"] = 0.12 * width
    motions: list[dict[str, Any]] = [
        {"kind": "harmonic", "peak_acceleration_m_s2": peak, "frequency_Hz": float(draw(0.8, 4.0))},
        {
            "kind": "pulse",
            "shape": str(pick(["half-sine", "sine", "rectangular"])),
            "peak_acceleration_m_s2": peak,
            "pulse_s": float(draw(0.2, 1.0)),
            "delay_s": 0.1,
        },
        {"kind": "none"},  # in its place a record
    ]
    motion = motions[int(pick(3))]
    tables: dict[str, Any] = {
        "container": {
            "width_m": width,
            "height_m": height,
            "boxes": boxes,
            "mass_kg": 1000.0 * width * width * height,
            "wall_m": 0.008,
            "centroid_m": float(draw(0.42, 0.52)) * height,
        },
        "support": support,
        "contact": {"mu_static": static, "mu_kinetic": static * float(pick([0.7, 0.9, 1.0]))},
        "motion": motion,
        "solver": {"model": "rigid", "element_size_m": 0.25 * width, "order": 1},
        "output": {"fields_s": 0.0, "figures": False},
    }
    if motion["kind"] == "harmonic":
        tables["solver"]["duration_s"] = float(draw(6.0, 12.0))
        if pick([True, False]):
            tables["vertical"] = {
                "kind": "harmonic",
                "peak_acceleration_m_s2": float(draw(0.5, 3.0)),
                "frequency_Hz": float(motion["frequency_Hz"]),
            }
    if pick([True, False]):
        tables["floor"] = {"preset": "concrete C25/30"}
        if support["kind"] == "corners":
            tables["floor"]["corner_patch_m"] = [0.15, 0.3]
    case = fem.case_from(tables)
    if motion["kind"] != "none":
        return case
    times, along = random_motion(int(generator.integers(2**31))).T
    upward = float(draw(0.5, 3.0)) * random_motion(int(generator.integers(2**31)))[:, 1]
    return case.with_motion(times, peak * along, upward if pick([True, False]) else None)


def changes_of(case: Case) -> Iterator[Change]:
    """Ordinary changes of a case."""
    contact, box = case.contact, case.container
    for factor in (0.9, 1.1):
        yield (
            f"friction x {factor}",
            {
                "contact.mu_static": factor * contact.mu_static,
                "contact.mu_kinetic": factor * contact.mu_kinetic,
            },
        )
    for factor in (0.75, 0.9):
        yield f"kinetic friction x {factor}", {"contact.mu_kinetic": factor * contact.mu_kinetic}
    for factor in (0.99, 1.01):
        yield f"width x {factor}", {"container.width_m": factor * box.width_m}
    for factor in (0.98, 1.02):
        yield f"mass centre x {factor}", {"container.centroid_m": factor * box.centroid_m}
    if case.motion.kind == "harmonic":
        yield "phase + 0.5", {"motion.phase_rad": 0.5}
        yield "duration x 1.2", {"solver.duration_s": 1.2 * float(case.solver.duration_s)}
    if case.floor.is_slab:
        yield "floor's E x 0.1", {"floor.youngs_modulus_Pa": 0.1 * float(case.floor.youngs_modulus_Pa or 0.0)}
    yield "reduced", {"solver.model": "reduced"}
    for factor in (0.95, 1.05):
        yield f"motion x {factor}", scaled_motion(case, factor)


def judged(seed: int) -> dict[str, Any]:
    """The verdict of a random case, and the changes that turn it over."""
    try:
        case = random_case(np.random.default_rng(seed))
        run = fem.compute(case, band=True, margin=False)
    except ValueError as error:
        return {"seed": seed, "sure": "refused", "reason": str(error).splitlines()[0]}
    began = time.process_time()
    verdict = run.verdict
    found: dict[str, Any] = {
        "seed": seed,
        "motion": case.motion.kind,
        "sure": verdict.sure,
        "outcome": verdict.outcome,
        "turned": [],
        "tried": 0,
    }
    if verdict.sure in ("sure", "regime unsure"):
        for name, values in changes_of(case):
            try:
                other = fem.compute(case.with_values(values), band=False, margin=False).verdict.outcome
            except ValueError:
                continue
            if other is not None:
                found["tried"] += 1
                if (other == "overturned") != (verdict.outcome == "overturned"):
                    found["turned"].append(name)
    return found | {"cpu_s": time.process_time() - began}


def main() -> int:
    """Print what the verdicts of random cases are worth."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else "")
    parser.add_argument("--cases", type=int, default=200)
    parser.add_argument("--seed", type=int, default=20261123)
    parser.add_argument("--jobs", type=int, default=2)
    given = parser.parse_args()
    seeds = [given.seed + k for k in range(given.cases)]
    with ProcessPoolExecutor(given.jobs) as pool:
        found = list(pool.map(judged, seeds))
    known = [one for one in found if one["sure"] not in ("refused", None)]
    print(f"{len(known)} of {len(found)} cases computed: {dict(Counter(one['sure'] for one in found))}")
    print(f"by motion: {dict(Counter((one['motion'], one['sure']) for one in known))}")
    wrong = 0.0
    for word in ("sure", "regime unsure"):
        some = [one for one in known if one["sure"] == word]
        turned = [one for one in some if one["turned"]]
        print(
            f"{word}: {len(some)} cases, {len(turned)} turned over: {Counter(n for o in turned for n in o['turned'])}"
        )
        print(
            f"  outcomes {dict(Counter(one['outcome'] for one in some))}; seeds {[one['seed'] for one in turned]}"
        )
        wrong = len(turned) / max(1, len(some)) if word == "sure" else wrong
    decided = sum(one["sure"] in ("sure", "regime unsure") for one in known) / max(1, len(known))
    met = wrong <= MOST_WRONG and decided >= LEAST_DECIDED
    print(
        f"wrong of the sure {wrong:.1%} (<= {MOST_WRONG:.0%}), decided {decided:.0%} (>= {LEAST_DECIDED:.0%})"
    )
    return 0 if met else 1


if __name__ == "__main__":
    sys.exit(main())
