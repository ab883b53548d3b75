"""Random valid cases over the whole schema, each by its number; and random damage to what the program reads.

A case of a number is the same wherever it is made, so that what a fuzz or a soak reports can be looked at again.
"""

import math
from typing import Any

import numpy as np

from fem.case.case import Case, CaseError, read_case
from fem.case.toml import toml_document

Tables = dict[str, Any]


def log_uniform(rng: np.random.Generator, low: float, high: float) -> float:
    return float(math.exp(rng.uniform(math.log(low), math.log(high))))


def chance(rng: np.random.Generator, share: float) -> bool:
    return bool(rng.random() < share)


def pick(rng: np.random.Generator, *choices: Any) -> Any:
    return choices[int(rng.integers(len(choices)))]


def random_tables(rng: np.random.Generator, model: str, longest: float) -> Tables:
    """Tables of a case that means something, mostly: sizes and ratios from everyday to absurd."""
    height = log_uniform(rng, 0.05, 5.0)
    width = height * log_uniform(rng, *((0.2, 3.0) if chance(rng, 0.8) else (0.02, 20.0)))
    boxes = int(rng.integers(1, 6) if chance(rng, 0.9) else rng.integers(1, 51))
    shell = chance(rng, 0.5)
    depth = width * log_uniform(rng, 0.5, 2.0)
    smallest = min(width, height, depth)
    container: Tables = {
        "width_m": width,
        "height_m": height,
        "depth_m": depth,
        "boxes": boxes,
        "density_kg_m3": log_uniform(rng, 300.0, 12e3),
        "section": "shell" if shell else "solid",
        "youngs_modulus_Pa": 2.1e11 if chance(rng, 0.4) else log_uniform(rng, 1e6, 1e13),
        "poisson_ratio": float(rng.uniform(0.0, 0.49)),
        "damping_ratio": pick(rng, 0.0, 0.02, float(rng.uniform(0.0, 0.9))),
    }
    if shell:
        container["wall_m"] = smallest * log_uniform(rng, 2e-3, 0.4)
        container["wall_density_kg_m3"] = 50.0
    elif chance(rng, 0.3):
        container["centroid_m"] = height * float(rng.uniform(0.34, 0.66))
    support = {"kind": pick(rng, "corners", "corners", "feet", "flat"), "foot_m": 0.15 * width}
    mu = pick(rng, 0.0, 0.4, float(rng.uniform(0.0, 1.0)), float(rng.uniform(0.0, 5.0)))
    contact: Tables = {
        "mu_static": mu,
        "mu_kinetic": mu * pick(rng, 1.0, 0.5, float(rng.random())),
        "friction": "regularised" if chance(rng, 0.15) else "elastic-stick",
        "damping_ratio": pick(rng, 2.0, 2.0, float(rng.uniform(0.0, 4.0))),
        "tangential_ratio": pick(rng, 1.0, log_uniform(rng, 0.1, 10.0)),
        "weakening_m": 1e-3 if chance(rng, 0.1) else 0.0,
        "stribeck_velocity_m_s": 0.3 if chance(rng, 0.1) else 0.0,
    }
    duration = log_uniform(rng, 0.05, longest)
    solver: Tables = {
        "model": model,
        "elastic_modes": int(rng.integers(0, 21)),
        "duration_s": duration,
        "element_size_m": max(width, height) * pick(rng, 0.5, 1.0),
        "order": pick(rng, 1, 2),
        "spectral_radius": pick(rng, 0.5, 0.5, float(rng.random())),
        "energy_tolerance": pick(rng, 1.0, 1.0, 10.0),
    }
    tables: Tables = {
        "gravity_m_s2": pick(rng, 9.81, 10.0, log_uniform(rng, 0.1, 50.0)),
        "container": container,
        "support": support,
        "contact": contact,
        "motion": random_motion(rng, width, height * boxes, duration),
        "solver": solver,
        "output": {
            "history_s": duration / float(rng.integers(5, 400)),
            "fields_s": 0.0,
            "stop_when_overturned": chance(rng, 0.8),
        },
    }
    if chance(rng, 0.4):
        angle = float(np.clip(rng.normal() * math.atan(width / (boxes * height)), -1.5, 1.5))
        spin, speed = pick(rng, 0.0, float(rng.normal() * 0.5)), pick(rng, 0.0, float(rng.normal()))
        tables["initial"] = {"rotation_rad": angle, "angular_velocity_rad_s": spin, "velocity_m_s": speed}
    return tables


def random_motion(rng: np.random.Generator, width: float, height: float, duration: float) -> Tables:
    """Motions about as strong as what lifts the container, from a tenth of that to ten times."""
    lift = min(9.81 * width / height * log_uniform(rng, 0.1, 10.0), 99.0)
    kind = pick(rng, "none", "harmonic", "harmonic", "pulse")
    if kind == "harmonic":
        frequency = log_uniform(rng, max(0.01, math.sqrt(lift / 9.9) / 6.28), 30.0)
        return {
            "kind": "harmonic",
            "peak_acceleration_m_s2": lift,
            "frequency_Hz": frequency,
            "phase_rad": float(rng.uniform(-6.28, 6.28)),
            "ramp_cycles": 0.25 * duration * frequency if chance(rng, 0.3) else 0.0,
            "start": pick(rng, "moving", "rest"),
        }
    if kind == "pulse":
        return {
            "kind": "pulse",
            "shape": pick(rng, "rectangular", "half-sine", "sine"),
            "peak_acceleration_m_s2": lift * pick(rng, -1.0, 1.0),
            "pulse_s": log_uniform(rng, 1e-5, 2.0),
            "delay_s": pick(rng, 0.0, 0.3 * duration),
        }
    return {"kind": "none"}


def random_case(number: int, model: str, longest: float = 20.0) -> Case:
    """The valid case of a number: tables are drawn until their rules are kept."""
    rng = np.random.default_rng([number, {"rigid": 0, "reduced": 1, "full": 2}[model]])
    for _ in range(100):
        text = toml_document(random_tables(rng, model, longest))
        try:
            return read_case(text, name=f"random {model} {number}")
        except CaseError:
            continue
    raise AssertionError(f"a hundred tables of number {number} break a rule")
