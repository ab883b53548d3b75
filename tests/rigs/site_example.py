"""Container K1 on site S1, and a result of `assess` of them as its page shows it, without a run.

K1: 1.1 m wide and deep, 4 m high, homogeneous, 10 t, mu 0.4 static, 0.2 kinetic. S1: type 1, ground D, a_g S 2.4 m/s2.
The tests hold hand-checked numbers of the simplified methods on them. The motions are shaped noise; `site_result.json`
holds the result in a building, but for its runs, which follow a pattern, and the methods beside them.
"""

import json
import math
from dataclasses import replace
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np

from contact.reference.rigid_block import RigidBlock
from fem.results.json_block import to_json
from fem.seismic.action import SiteAction, eurocode_shape
from fem.seismic.body import FloorAction, LooseBody
from fem.site.methods import site_methods
from fem.site.result import MOTIONS, RESULT_FILE, SiteBody, SiteMotion, SiteResult, SiteRun
from fem.site.tables import LimitsTable

SITE = SiteAction(shape=eurocode_shape(1, "D"), reference_acceleration=2.4 / 1.35)
#: 0.06 (S_alpha S_beta)^0.55 with the plateau and the value at 1 s
PEAK_VELOCITY = 0.06 * (6.0 * 4.8) ** 0.55
ACTION = FloorAction.on_ground(SITE, PEAK_VELOCITY)
SLIP = 0.1  #: the clearance [m]

STEP = 0.01
FOUND = {"outcome": "rock", "rotation_ratio": 0.1, "max_slip_m": 0.01}
RUN = SiteRun(motion=1, vertical_sign=1, mu_static=0.4, mu_kinetic=0.2, mass="full", model="rigid", **FOUND)
STORED = SiteResult.from_json(
    json.loads((Path(__file__).parent / "site_result.json").read_text(encoding="utf-8"))
)
INPUTS, PERIODS = STORED.inputs, np.array(STORED.action.periods_s)
LIMITS = LimitsTable(
    rotation_ratio=INPUTS.rotation_ratio_limit,
    single_rotation_ratio=INPUTS.single_rotation_ratio_limit,
    slip_m=INPUTS.slip_limit_m,
)
SENTENCES = {
    None: "Not valid: the set of motions fails its checks.",
    True: "Fulfilled under the stated rule: none of 112 runs overturned.",
    False: "Not fulfilled under the stated rule: {} of 112 runs overturned.",
}


def k1(*, mu_static: float = 0.4, mu_kinetic: float = 0.2) -> LooseBody:
    block, size = RigidBlock.homogeneous(width=1.1, height=4.0), {"width": 1.1, "height": 4.0, "depth": 1.1}
    return LooseBody(block=block, **size, mass=10_000.0, mu_static=mu_static, mu_kinetic=mu_kinetic)


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
    return STORED.set.motions[number - 1], files


def site_body(mass: str) -> SiteBody:
    return next(body for body in STORED.bodies if body.mass == mass)


def example(
    *, overturned: int = 0, valid: bool = True, building: bool = False
) -> tuple[SiteResult, dict[str, str]]:
    """A result, and the files of its motions; so many runs overturn, and the set may fail its checks."""
    floor, periods = (STORED.floor, STORED.floor.building_periods_s) if building else (None, (None,))
    motions, bodies = STORED.set.motions, STORED.bodies
    runs = []
    for motion, sign, mu, share, mass, period in product(
        range(1, 8), (1, -1), (0.2, 0.4), (0.5, 1.0), ("full", "empty"), periods
    ):
        run = replace(RUN, motion=motion, vertical_sign=sign, mass=mass, building_period_s=period)
        run = replace(run, mu_static=mu, mu_kinetic=share * mu, rotation_ratio=0.002 * motion)
        slid = ("slide", 0.003 * motion * (0.4 - mu)) if mu == 0.2 else ("rest", 1e-6)
        runs.append(replace(run, outcome=slid[0], max_slip_m=slid[1]))
    runs[:overturned] = [replace(run, outcome="overturned", rotation_ratio=2.0) for run in runs[:overturned]]
    found, fulfilled = STORED.set, overturned == 0 if valid else None
    if not valid:
        at = f"{found.least_ratio_period_s:.3g} s"
        checks = [replace(one, fulfilled=one.fulfilled and " at " not in one.name) for one in found.checks]
        reasons = (f"the mean spectrum is {found.least_ratio:.2f} of the target at {at}",)
        found = replace(found, valid=False, checks=tuple(checks), reasons=reasons)
    answer = {None: None, True: "fulfilled", False: "not fulfilled"}[fulfilled]
    earthquake, wind = STORED.result.actions
    governing = runs[0] if overturned else max(runs, key=lambda run: run.max_slip_m)
    result = replace(
        STORED.result,
        answer=answer,
        fulfilled=fulfilled,
        sentence=SENTENCES[fulfilled].format(overturned),
        overturned=overturned,
        runs=len(runs) if valid else 0,
        governing=governing,
        confirmed=tuple(replace(one, run=governing) for one in STORED.result.confirmed),
        actions=(replace(earthquake, answer=answer and ("fulfilled" if fulfilled else None)), wind),
    )
    kept, periods_s = tuple(runs) if valid else (), STORED.action.periods_s
    given = {"motions": motions, "periods_s": periods_s, "floor": floor, "runs": kept}
    methods = site_methods(bodies=bodies, inputs=INPUTS, limits=LIMITS, site=SITE, **given)
    files = {name: text for number in range(1, 8) for name, text in site_motion(number)[1].items()}
    return replace(STORED, floor=floor, set=found, runs=kept, result=result, methods=methods), files


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
