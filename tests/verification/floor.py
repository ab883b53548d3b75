"""The physical floor: corners that crush it, and a floor that slopes.

Crushing: a landing without dashpot in closed form, the work against force and indentation, and Housner's restitution
whatever stiffness, cap and dashpot. A slope: in the frame of the floor gravity is g cos toward it, and its part along
it acts as an acceleration -g sin of the floor; slider and block of `contact.reference` take it as that. Stack and box
are those of `runs`.
"""

import math
from itertools import product

import numpy as np
import runs
from evidence.findings import Convergence, analytic, computed
from floors import sine_floor
from verification.bodies import Flight, free_run
from verification.checks import MESH, Findings, check
from verification.rocking import difference_of_rotation
from verification.sliding import slip_of_a_driven_box

from contact.stepping.ledger import CRUSHING, IMBALANCE
from contact.stepping.modal_body import make_modal_body
from contact.stepping.scheme import generalised_alpha
from fem.model.model import build_model
from fem.solid.nodal_body import advance_body

#: of the landing: mass [kg], springs of both corners [N/m], speed [m/s]
MASS, SPRINGS, SPEED = 2500.0, 2.5e8, 0.5
GROWTH = 500.0  #: of a cap with the indentation, about that of the edge of a wall [1/m]
#: what bears under a corner of the stack, along x and out of plane [m]; its stiffness [N/m], cap [N], damping ratio
PATCH = [0.1, 0.2]
STIFFNESSES, CAPS = (2.8e9, 8.1e9), (0.3e6, 0.6e6, 1.2e6)
#: damping ratios of the contact, with the tolerance of Housner's restitution
RATIOS = {(0.0, 0.05): 2e-2, (0.3, 1.0): 8e-3}
OMEGA = 6.928
STIFF: runs.Keys = {"contact.normal_penalty_Pa_m": 5e10, "output.history_s": 0.002, "solver.duration_s": 2.0}
MOST_ATTEMPTS = 1_000_000  #: of steps, without a fault some thousands


def landed(share: float, step: float, growth: float = 0.0) -> tuple[Flight, float, float]:
    """A rigid block that lands flat, without gravity and dashpot, its cap this share of the elastic peak force.

    `growth` is that of the cap with the indentation, over the cap [1/m]. Found are the flight after it, the cap of both
    intact corners together [N], and the exact indentation [m].
    """
    point = np.array([[-0.5, -0.5], [0.5, -0.5]])
    body = make_modal_body(mass=MASS, inertia=MASS, gravity=0.0, point=point, rest=(0.0, 0.5), tolerance=1e-9)
    cap = share * SPEED * math.sqrt(SPRINGS * MASS)
    flight = free_run(
        body,
        step=step,
        scheme=generalised_alpha(0.5),
        springs=np.full(2, 0.5 * SPRINGS),
        caps=np.full(2, 0.5 * cap),
        growth=growth,
        speed=-SPEED,
    )
    # F (w + g w^2/2) + F^2 (1 + g w)^2/(2 k) = m v^2/2
    held = cap / SPRINGS
    square, linear = 0.5 * growth * (1.0 + growth * held), 1.0 + growth * held
    rest = 0.5 * held - 0.5 * MASS * SPEED**2 / cap
    exact = -2.0 * rest / (linear + math.sqrt(linear**2 - 4.0 * square * rest))
    return flight.advance(0.05), cap, exact


@check("floor", "a landing that crushes the floor")
def landing() -> Findings:
    """What the springs hold at the cap comes back, the rest indents the floor; second order in the step."""
    source = "m v^2/2 - F^2/(2 k) = F w, rebound F/sqrt(k m)"
    for share in (0.3, 0.6, 0.9):
        flight, cap, exact = landed(share, 5e-5)
        case = f"rigid block, cap {share:g} of the elastic force"
        for compared, value, by_hand, within in (
            ("indentation [m]", flight.state.crushed.max(), exact, 3e-4),
            ("speed of the rebound [m/s]", flight.state.velocity[1], share * SPEED, 3e-4),
            ("work of crushing [J]", flight.run.ledger[CRUSHING], cap * exact, 5e-4),
        ):
            yield analytic(case, compared, value, by_hand, source=source, relative=within)
    flight, cap, exact = landed(0.5, 2e-5, GROWTH)
    case, ended = f"rigid block, a cap that grows by {GROWTH:g}/m", cap * (1.0 + GROWTH * exact)
    rebound, speed = ended / math.sqrt(SPRINGS * MASS), flight.state.velocity[1]
    law = "m v^2/2 - F(w)^2/(2 k) = F (w + g w^2/2), F(w) = F (1 + g w), rebound F(w)/sqrt(k m)"
    for compared, value, by_hand in (
        ("indentation [m]", flight.state.crushed.max(), exact),
        ("speed of the rebound [m/s]", speed, rebound),
        ("work of crushing [J]", flight.run.ledger[CRUSHING], 0.5 * MASS * (SPEED**2 - rebound**2)),
    ):
        yield analytic(case, compared, value, by_hand, source=law, relative=2e-3)
    errors = {}
    for step in (4e-4, 2e-4, 1e-4, 5e-5):
        # the error of one run depends on where in a step the crushing begins
        landings = [landed(share, step) for share in np.linspace(0.3, 0.7, 21)]
        errors[step] = np.mean([abs(flight.state.crushed[0] / exact - 1.0) for flight, _, exact in landings])
    yield analytic(
        "mean of 21 caps from 0.3 to 0.7",
        "indentation, error over the exact one",
        source=source,
        convergence=Convergence("step [s]", errors, order=2.0, within=0.25),
    )


def slab(stiffness: float, cap: float, ratio: float | None = None) -> runs.Keys:
    """Keys of a slab with this stiffness [N/m] and cap [N] of a corner, and damping ratio of the contact."""
    keys: runs.Keys = {
        "floor.kind": "slab",
        "floor.corner_patch_m": PATCH,
        "floor.youngs_modulus_Pa": 31e9,
        "floor.poisson_ratio": 0.2,
        "floor.bearing_strength_Pa": cap / (PATCH[0] * PATCH[1]),
    }
    default = float(build_model(runs.STACK.with_values(keys)).run.problem.contact.normal_stiffness[0])
    keys["floor.youngs_modulus_Pa"] *= stiffness / default
    return keys if ratio is None else keys | {"contact.damping_ratio": ratio}


@check("floor", "the work of crushing", inputs="Forces, indentations and cap are those of the run.")
def work_of_crushing() -> Findings:
    """The ledger's work against the area under force and indentation, added up from the outside; energy closes."""
    driven = runs.harmonic(4.0 / OMEGA**2, OMEGA) | {"solver.duration_s": 3.0}
    for name, keys in runs.STACKS.items():
        model = build_model(runs.STACK.with_values(driven | keys | slab(8.1e9, 0.44e6)))
        state, area = model.run, 0.0  # under force and permanent indentation of all points, step by step [J]
        while float(state.clock[0].time) < model.duration:
            force, crushed = state.old.force[:, 1].copy(), state.old.crushed.copy()
            attempts = int(state.clock[0].steps + state.clock[0].rejected)
            if attempts > MOST_ATTEMPTS:
                raise ArithmeticError(f"it makes no progress at {state.clock[0].time} s")
            state.clock[0].attempt_limit = attempts + 1
            advance_body(model.body, state, model.duration)
            state.clock[0].samples_drained = state.clock[0].samples
            area += float((0.5 * (force + state.old.force[:, 1]) * (state.old.crushed - crushed)).sum())
        ledger, reference = model.run.ledger, model.run.problem.control.reference_energy
        case = f"{name}, 4 m/s2 at {OMEGA} rad/s, 3 s, cap 0.44 MN"
        source = "sum of force times indentation over all steps"
        yield computed(case, "work of crushing [J]", ledger[CRUSHING], area, source=source, relative=1e-12)
        contact, deep = model.run.problem.contact, model.run.old.crushed
        at_cap = float((contact.cap * deep * (1.0 + 0.5 * contact.cap_growth * deep)).sum())
        source = "area under the cap over the indentation"
        yield analytic(case, "work of crushing [J]", ledger[CRUSHING], at_cap, source=source, relative=2e-2)
        balance = abs(float(ledger[IMBALANCE])) / reference
        compared = "imbalance over the energy to overturn"
        yield analytic(case, compared, balance, source="energy closes", absolute=2e-3)


@check("floor", "restitution of a corner that crushes", inputs=MESH)
def restitution() -> Findings:
    """Housner's whatever the cap, the stiffness and the dashpot, to what the springs hold at the cap and give back."""
    free: runs.Keys = runs.TILTED | {"contact.mu_static": 0.8, "solver.duration_s": 2.5}
    for stiffness, cap, (ratios, tolerance) in product(STIFFNESSES, CAPS, RATIOS.items()):
        finished = {ratio: runs.run(runs.STACK, free | slab(stiffness, cap, ratio)) for ratio in ratios}
        exact = finished[ratios[0]].block.housner_restitution  # about where it turns on a weak floor
        found = {ratio: done.restitution for ratio, done in finished.items()}
        worst, value = max(found.items(), key=lambda item: abs(item[1] - exact))
        yield analytic(
            f"rigid stack, {stiffness:g} N/m, cap {1e-6 * cap:g} MN, damping ratio {worst:g}, the worse of two",
            "velocity ratio at the first impact",
            value,
            exact,
            source="1 - (M R^2/I_O)(1 - cos 2 al), Housner 1963",
            absolute=tolerance,
        )


@check("floor", "limit of an incline")
def incline_limit() -> Findings:
    """A box begins to slide where the slope is mu_static, to either side."""
    for sign, (name, keys) in product(
        (1.0, -1.0), {"rigid box": {}, "solid box, 20 modes": runs.SOLID}.items()
    ):
        held = keys | {"contact.mu_static": 0.1, "solver.duration_s": 1.0}

        def slides(per_cent: float, held: runs.Keys = held, sign: float = sign) -> bool:
            done = runs.run(runs.BOX, held | {"floor.slope_percent": sign * per_cent})
            return abs(float(done.joint.slip)) > 1e-5

        limit = runs.bisected(slides, 9.0, 11.0, resolution=1e-3)
        case = f"{name}, mu 0.1, floor falls toward {'+x' if sign > 0.0 else '-x'}"
        yield analytic(case, "limit of the slope [%]", limit, 10.0, source="tan = mu", relative=5e-3)


@check("floor", "a slider on a slope")
def slider_on_slope() -> Findings:
    """Slip that a slope makes one-sided, over 5 s."""
    for per_cent in (2.0, -10.0):
        angle = math.atan(0.01 * per_cent)
        floor = sine_floor(amplitude=0.05, angular_frequency=10.0).on_slope(runs.GRAVITY * math.sin(angle))
        slope = {"floor.slope_percent": per_cent, "floor.motion_along": "floor"}
        yield slip_of_a_driven_box(f"slope {per_cent:g} %", slope, floor, runs.GRAVITY * math.cos(angle))


@check("floor", "a block on a slope", inputs=f"{MESH} So does the part of gravity along the slope.")
def block_on_slope() -> Findings:
    """Rotation of the stack up to the first impact, driven on a slope."""
    for per_cent, (name, keys) in product((3.0, -3.0), runs.STACKS.items()):
        values = runs.harmonic(4.5 / OMEGA**2, OMEGA) | STIFF | keys | {"floor.slope_percent": per_cent}
        done = runs.run(runs.STACK, values | {"floor.motion_along": "floor"})
        floor = sine_floor(amplitude=4.5 / OMEGA**2, angular_frequency=OMEGA)
        yield computed(
            f"{name}, mu 1, 4.5 m/s2 at {OMEGA} rad/s, slope {per_cent:g} %",
            "rotation up to the first impact, largest difference over the slenderness angle",
            difference_of_rotation(done, floor.on_slope(done.model.run.problem.control.downhill)),
            source="event-driven block",
            absolute=2e-3 if keys else 1e-3,
        )
