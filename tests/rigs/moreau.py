"""Rigid boxes, one on the other, by time stepping with plastic impacts: Moreau's scheme, apart from the program.

Steps of one size with impulses at their ends: positions at mid-step decide which corners touch, velocities after the
step meet Signorini's condition (they do not close) and Coulomb's law, by projected Gauss-Seidel over the contacts, each
of which is solved exactly. Corners of a box touch the face below, corners of that face touch the box above. Frame of
the floor. Nothing bounces and nothing is elastic.
Moreau, Unilateral contact and dry friction in finite freedom dynamics, in: Nonsmooth Mechanics
and Applications, CISM 302 (1988); Jean, Comput. Methods Appl. Mech. Eng. 177 (1999) 235.

`slide_and_rock` is the same for one box, with both its corners solved in closed form: the kernel that the program's
rigid batch is measured against.
"""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

SWEEPS, CONVERGED = 400, 1e-6  #: of Gauss-Seidel; largest change of an impulse over the weight in a step
CLOSED = 1e-8  #: gap of a contact that is closed but for rounding [m]
LARGEST_ROTATION = 1.2  #: of a box that stands [rad]


class Boxes(NamedTuple):
    """Homogeneous boxes on one axis, from the floor up."""

    width: Sequence[float]  #: [m]
    height: Sequence[float]  #: [m]
    mass: Sequence[float]  #: [kg]

    @property
    def inertia(self) -> FloatArray:
        """About the mass centres, shape (n,) [kg m2]."""
        width, height, mass = map(np.array, self)
        return np.asarray(mass * (width**2 + height**2) / 12.0)

    @property
    def upright(self) -> FloatArray:
        """Places of the mass centres and rotations at rest, shape (n, 3)."""
        bottom = np.array([0.0, *np.cumsum(self.height)[:-1]])
        return np.stack([0.0 * bottom, bottom + 0.5 * np.array(self.height), 0.0 * bottom], axis=1)


class BoxMotion(NamedTuple):
    """What boxes did; slip is that of a box over what is below, positive along +x."""

    times: FloatArray  #: of the samples [s]
    place: FloatArray  #: x, z of the mass centres and rotations, shape (samples, n, 3)
    slip: FloatArray  #: shape (samples, n) [m]
    max_rotation: FloatArray  #: shape (n,) [rad]
    max_slip: FloatArray  #: shape (n,) [m]
    fell_at: float  #: when a box fell or lost its footing; inf: never [s]
    fell_box: int  #: from 0, from the floor up; -1: none


def move_boxes(
    boxes: Boxes,
    along: FloatArray,
    *,
    step: float,
    mu_static: float | FloatArray,
    mu_kinetic: float | FloatArray | None = None,
    gravity: float = 9.81,
    every: int = 10,
) -> BoxMotion:
    """Follow boxes that stand at rest on a floor.

    Args:
        along: acceleration of the floor at the middle of each step, shape (steps,) [m/s2].
        step: [s].
        mu_static, mu_kinetic: below each box, shape (n,), or everywhere; static until all contacts of an interface
            slide one way, kinetic from the next step until they do not. No mu_kinetic: mu_static.
        every: steps between samples.
    """
    n = len(boxes.mass)
    static = np.full(n, mu_static, dtype=float)
    kinetic = static if mu_kinetic is None else np.full(n, mu_kinetic, dtype=float)
    q, v = boxes.upright, np.zeros((n, 3))
    samples = along.size // every + 1
    places, slips = np.full((samples, n, 3), np.nan), np.full((samples, n), np.nan)
    most = np.zeros((n, 2))
    width, height, mass = map(np.array, boxes)
    size = np.stack([0.5 * width, height, 0.5 * height, mass, boxes.inertia], axis=1)
    fell_at, fell_box = _advance(
        size, static, kinetic, gravity, np.asarray(along, float), step, every, q, v, places, slips, most
    )
    return BoxMotion(
        times=step * every * np.arange(samples),
        place=places,
        slip=slips,
        max_rotation=most[:, 0],
        max_slip=most[:, 1],
        fell_at=fell_at,
        fell_box=fell_box,
    )


@numba.njit(cache=True)
def _advance(size, static, kinetic, gravity, along, h, every, q, v, places, slips, most):
    n = q.shape[0]
    count = 2 + 4 * (n - 1)
    impulse, mu = np.zeros((count, 2)), static.copy()
    row, active = np.zeros((count, 2, 2, 3)), np.zeros(count, np.bool_)
    compliance, slip = np.zeros((count, 3)), np.zeros(n)
    before, had = np.zeros_like(v), np.zeros(count, np.bool_)
    places[0] = q
    slips[0] = slip
    for k in range(along.size):
        for b in range(n):  # the middle of the step
            for i in range(3):
                q[b, i] += 0.5 * h * v[b, i]
        before[:] = v
        had[:] = active
        for b in range(n):
            v[b, 0] -= h * along[k]
            v[b, 1] -= h * gravity
        _find_contacts(size, q, row, active)
        _solve(size, mu, h * gravity, row, active, compliance, impulse, v)
        for j in range(n):
            loaded, slides, rate = 0.0, 0, 0.0
            for c in range(0 if j == 0 else 4 * j - 2, 4 * j + 2):
                normal, friction = impulse[c, 0], impulse[c, 1]
                if not active[c] or normal <= 0.0:
                    continue
                relative = _rate(row[c, 1], j, v)
                if had[c]:  # over the whole step
                    relative = 0.5 * (relative + _rate(row[c, 1], j, before))
                rate += normal * relative
                loaded += normal
                at_limit = abs(friction) >= mu[j] * normal * (1.0 - 1e-9)
                sense = (1 if friction < 0.0 else -1) if at_limit else 0
                slides = sense if slides in (0, sense) and sense != 0 else 9
            if loaded > 0.0:
                slip[j] += h * rate / loaded
                mu[j] = kinetic[j] if slides in (1, -1) else static[j]
        for b in range(n):
            for i in range(3):
                q[b, i] += 0.5 * h * v[b, i]
            most[b, 0] = max(most[b, 0], abs(q[b, 2]))
            most[b, 1] = max(most[b, 1], abs(slip[b]))
        if (k + 1) % every == 0:
            places[(k + 1) // every] = q
            slips[(k + 1) // every] = slip
        for b in range(n):
            if _has_fallen(size, q, b):
                return (k + 1) * h, b
    return np.inf, -1


@numba.njit(cache=True)
def _has_fallen(size, q, b):
    """Turned too far, down to the floor, or not over the box below."""
    if abs(q[b, 2]) > LARGEST_ROTATION:
        return True
    if b == 0:
        return False
    cosine, sine = math.cos(q[b, 2]), abs(math.sin(q[b, 2]))
    if q[b, 1] - size[b, 2] * cosine - size[b, 0] * sine < 0.0:
        return True
    low = q[b - 1]
    x, z = q[b, 0] - low[0], q[b, 1] - low[1]
    over = math.cos(low[2]) * x - math.sin(low[2]) * z
    return abs(over) > size[b - 1, 0] + size[b, 0]


@numba.njit(cache=True)
def _rate(jacobian, upper, v):
    total = 0.0
    for i in range(3):
        total += jacobian[0, i] * v[upper, i]
        if upper > 0:
            total += jacobian[1, i] * v[upper - 1, i]
    return total


@numba.njit(cache=True)
def _find_contacts(size, q, row, active):
    """Corners that touch a face, and how their normal and tangential velocities follow from those of the boxes.

    Contact 0, 1: the lowest box on the floor; 4 j - 2 ..: left and right corners of box j on the face below, then
    left and right top corners of box j - 1 on the face above. The row of a contact: normal and tangent, upper and
    lower box.
    """
    for c in range(active.size):
        active[c] = False
    for b in range(q.shape[0]):
        for corner in range(2 if b == 0 else 4):
            c = corner if b == 0 else 4 * b - 2 + corner
            side = -1.0 if corner % 2 == 0 else 1.0
            owner = b if corner < 2 else b - 1  # of the corner; the other one has the face
            x = side * size[owner, 0]
            z = -size[owner, 2] if corner < 2 else size[owner, 1] - size[owner, 2]
            cosine, sine = math.cos(q[owner, 2]), math.sin(q[owner, 2])
            px, pz = q[owner, 0] + cosine * x + sine * z, q[owner, 1] - sine * x + cosine * z
            if b == 0:
                nx, nz, gap = 0.0, 1.0, pz
            else:
                face = b - 1 if corner < 2 else b
                cosine, sine = math.cos(q[face, 2]), math.sin(q[face, 2])
                dx, dz = px - q[face, 0], pz - q[face, 1]
                nx, nz = sine, cosine
                place, level = cosine * dx - sine * dz, sine * dx + cosine * dz
                if abs(place) > size[face, 0] * (1.0 + 1e-9):
                    continue
                gap = level - (size[face, 1] - size[face, 2]) if corner < 2 else -size[face, 2] - level
            if gap > CLOSED:
                continue
            active[c] = True
            for which, body, sign in ((0, b, 1.0), (1, b - 1, -1.0)):
                if body < 0:
                    continue
                rx, rz = px - q[body, 0], pz - q[body, 1]
                row[c, 0, which, 0], row[c, 0, which, 1] = sign * nx, sign * nz
                row[c, 0, which, 2] = sign * (nx * rz - nz * rx)
                row[c, 1, which, 0], row[c, 1, which, 1] = sign * nz, -sign * nx
                row[c, 1, which, 2] = sign * (nz * rz + nx * rx)


@numba.njit(cache=True)
def _upper_box(c):
    return 0 if c < 2 else (c + 2) // 4


@numba.njit(cache=True)
def _push(size, row, b, normal, friction, v):
    """Change velocities by an impulse."""
    for which in range(2 if b > 0 else 1):
        body = b - which
        for i in range(3):
            inertia = size[body, 4] if i == 2 else size[body, 3]
            v[body, i] += (row[0, which, i] * normal + row[1, which, i] * friction) / inertia


@numba.njit(cache=True)
def _solve(size, mu, kick, row, active, compliance, impulse, v):
    """Impulses of all contacts, from those of the step before; `v` becomes the velocity after them."""
    for c in range(active.size):
        if active[c]:
            b = _upper_box(c)
            _push(size, row[c], b, impulse[c, 0], impulse[c, 1], v)
            compliance[c] = 0.0
            for which in range(2 if b > 0 else 1):
                body = b - which
                for i in range(3):
                    inertia = size[body, 4] if i == 2 else size[body, 3]
                    compliance[c, 0] += row[c, 0, which, i] ** 2 / inertia
                    compliance[c, 1] += row[c, 0, which, i] * row[c, 1, which, i] / inertia
                    compliance[c, 2] += row[c, 1, which, i] ** 2 / inertia
        else:
            impulse[c, 0] = impulse[c, 1] = 0.0
    for _ in range(SWEEPS):
        change = 0.0
        for c in range(active.size):
            if not active[c]:
                continue
            b = _upper_box(c)
            nn, nt, tt = compliance[c, 0], compliance[c, 1], compliance[c, 2]
            # velocities without this contact
            was_n, was_t = impulse[c, 0], impulse[c, 1]
            un = _rate(row[c, 0], b, v) - nn * was_n - nt * was_t
            ut = _rate(row[c, 1], b, v) - nt * was_n - tt * was_t
            normal, friction = one_contact(nn, nt, tt, un, ut, mu[b])
            _push(size, row[c], b, normal - was_n, friction - was_t, v)
            impulse[c, 0], impulse[c, 1] = normal, friction
            change = max(change, (abs(normal - was_n) + abs(friction - was_t)) / size[b, 3])
        if change < CONVERGED * kick:
            return


@numba.njit(cache=True)
def one_contact(nn, nt, tt, un, ut, mu):
    """Normal and friction impulse of one contact, from its compliance and the velocity that it would have without."""
    determinant = nn * tt - nt * nt
    normal, friction = (nt * ut - tt * un) / determinant, (nt * un - nn * ut) / determinant
    if normal > 0.0 and abs(friction) <= mu * normal:
        return normal, friction
    if normal <= 0.0 and un >= 0.0:
        return 0.0, 0.0
    sense = 1.0 if friction > 0.0 else -1.0
    for sign in (sense, -sense):
        effective = nn + sign * mu * nt
        if effective > 0.0 and un < 0.0:
            normal = -un / effective
            # friction must oppose the slip that remains
            if sign * (ut + nt * normal + tt * sign * mu * normal) <= 0.0:
                return normal, sign * mu * normal
    return 0.0, 0.0


@numba.njit(cache=True)
def slide_and_rock(block, mus, gravity, amplitude, frequency, jerk, h, steps, found):
    """Runs of one box each on floors A sin(Omega t), each until the end or until it has overturned.

    Args:
        block: half width, height of the mass centre, mass over inertia about it; shape (runs, 3).
        mus: static, kinetic friction; shape (runs, 2).
        amplitude, frequency: A [m], Omega [rad/s]; shape (runs,).
        jerk: whether the boxes are at rest when the floor starts; else they move with it.
        found: largest |rotation| [rad], largest |slip| of the loaded corners [m], overturned; (runs, 3), written.
    """
    half, pull = 0.5 * h, h * gravity
    for r in range(amplitude.size):
        rate, b, c, ratio, mu = frequency[r], block[r, 0], block[r, 1], block[r, 2], mus[r, 0]
        u = -amplitude[r] * rate if jerk else 0.0
        z, angle, w, spin, slip, most_angle, most_slip = c, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        for k in range(steps):
            angle += half * spin
            z += half * w
            push = h * -amplitude[r] * rate * rate * math.sin(rate * (k + 0.5) * h)
            u -= push
            w -= pull
            cosine, sine = math.cos(angle), math.sin(angle)
            drop, lift = c * cosine, b * sine
            left, right = z - drop + lift <= CLOSED, z - drop - lift <= CLOSED
            if left or right:
                slides = 0.0
                arm = -c * cosine  # height of the corners, but for the lift
                back, ahead = -b * cosine - c * sine, b * cosine - c * sine
                flat = False
                if left and right:  # the whole base: velocities of a box that lies
                    normal, friction = -w, -u
                    if abs(friction) > mu * normal:
                        friction = math.copysign(mu * normal, friction)
                    # moment: friction x arm - (normal_left back + normal_right ahead)
                    on_right = (spin / ratio + friction * arm - normal * back) / (ahead - back)
                    flat = normal > 0.0 and 0.0 <= on_right <= normal
                    if flat:
                        slides = 1.0 if friction != -u else 0.0
                        slip += half * (u + push + u + friction)
                        u += friction
                        w, spin = 0.0, 0.0
                if not flat:
                    if left and right:  # the corner that goes down is the one to stand on
                        left = w - spin * back < w - spin * ahead
                    offset, rise = (back, arm + lift) if left else (ahead, arm - lift)
                    nn, tt = 1.0 + ratio * offset * offset, 1.0 + ratio * rise * rise
                    nt, un, ut = -ratio * offset * rise, w - spin * offset, u + spin * rise
                    normal, friction = one_contact(nn, nt, tt, un, ut, mu)
                    u += friction
                    w += normal
                    spin += ratio * (friction * rise - normal * offset)
                    if normal > 0.0:
                        if abs(friction) >= mu * normal * (1.0 - 1e-9):
                            slides = 1.0
                        slip += h * (u + spin * rise)
                mu = mus[r, 1] if slides != 0.0 else mus[r, 0]
            z += half * w
            angle += half * spin
            most_angle, most_slip = max(most_angle, abs(angle)), max(most_slip, abs(slip))
            if most_angle > LARGEST_ROTATION:
                break
        found[r, 0], found[r, 1], found[r, 2] = most_angle, most_slip, most_angle > LARGEST_ROTATION


@numba.njit(cache=True)
def slide_in_a_row(mass, gap, velocity, mu, restitution, pulse, duration, gravity=9.81, step=1e-5):
    """Where blocks that only slide, side by side, end on a floor under a rectangular pulse: their slip, shape (n,) [m].

    Per step an impulse of friction, at most that which stops a block; then Newton's law of restitution at the gaps that
    are closed and close, one after the other until none does.

    Args:
        mass: shape (n,); gap: between them, shape (n - 1,) [m]; velocity: at the start, over the floor [m/s].
        pulse: acceleration of the floor [m/s2] and its length [s].
    """
    n = mass.size
    slip, speed = np.zeros(n), velocity.copy()
    for k in range(int(duration / step)):
        push = -pulse[0] * step if k * step < pulse[1] else 0.0
        for b in range(n):
            free = speed[b] + push
            most = mu * gravity * step
            speed[b] = math.copysign(max(abs(free) - most, 0.0), free)
        for _ in range(100):
            closes = False
            for g in range(n - 1):
                closing = speed[g] - speed[g + 1]
                if slip[g] - slip[g + 1] >= gap[g] and closing > 0.0:
                    # what closes no faster than friction and pulse make it in a step does not bounce
                    rebound = restitution if closing > 2.0 * (mu * gravity + abs(pulse[0])) * step else 0.0
                    impulse = (1.0 + rebound) * closing * mass[g] * mass[g + 1] / (mass[g] + mass[g + 1])
                    speed[g] -= impulse / mass[g]
                    speed[g + 1] += impulse / mass[g + 1]
                    closes = True
            if not closes:
                break
        for b in range(n):
            slip[b] += step * speed[b]
    return slip
