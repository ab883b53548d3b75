"""A body that slides in the plane of its floor, against closed forms and the event-driven slider."""

import math

import numpy as np
import pytest
from rigid_slider import RigidSlider, simulate_sliding

import fem
from contact.reference.floor_acceleration import FloorAcceleration
from contact.stepping.plane_slider import slide_over

G = 9.81
TIMES = np.arange(0.0, 10.0, 0.01)
JUMP = 1e-9  #: within which an acceleration changes at once [s]


def record(seed, peak):
    """A broad-band acceleration around 2.5 Hz, (n,) [m/s2]."""
    noise = np.fft.rfft(np.random.default_rng(seed).normal(size=TIMES.size))
    noise *= np.exp(-(((np.fft.rfftfreq(TIMES.size, 0.01) - 2.5) / 2.0) ** 2))
    shaped = np.fft.irfft(noise, TIMES.size) * np.sin(np.pi * TIMES / TIMES[-1])
    return peak * shaped / np.abs(shaped).max()


def held(pieces):
    """Times and accelerations of pieces (length [s], ax, ay, up) that are constant."""
    times, values = [], []
    begin = 0.0
    for length, *acceleration in pieces:
        times += [begin, begin + length - JUMP]
        values += [acceleration, acceleration]
        begin += length
    return np.array(times), np.array(values).T


def circle(step, *, amplitude=0.1, rate=7.0, mu=0.2):
    """Radius of the steady path over a floor that moves on a circle [m]."""
    times = np.arange(0.0, 30.0, step)
    peak = -amplitude * rate**2
    slip = fem.slide_in_plane(times, peak * np.cos(rate * times), peak * np.sin(rate * times), mu_static=mu)
    last = slip[times > 25.0]
    # least squares circle: x^2 + y^2 = 2 x c_x + 2 y c_y + (r^2 - c^2)
    columns = np.column_stack([2.0 * last, np.ones(len(last))])
    fit = np.linalg.lstsq(columns, (last**2).sum(axis=1), rcond=None)
    centre = fit[0]
    return math.sqrt(centre[2] + centre[0] ** 2 + centre[1] ** 2)


def test_on_a_floor_that_moves_on_a_circle_the_relative_path_is_a_circle():
    # A w^2, the friction mu g and the relative r w^2 are the sides of a right-angled triangle
    exact = math.sqrt(0.1**2 - (0.2 * G / 49.0) ** 2)
    assert exact == pytest.approx(0.09163, abs=5e-6)
    errors = [abs(circle(step) - exact) for step in (0.01, 0.005, 0.0025)]
    assert errors[-1] < 5e-6
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.05)  # of the interpolation: second order
    assert errors[1] / errors[2] == pytest.approx(4.0, rel=0.05)


@pytest.mark.parametrize("kinetic", [0.3, 0.2])
def test_a_turned_motion_gives_the_turned_path(kinetic):
    x, y, up = record(1, 6.0), record(2, 6.0), record(3, 4.0)
    cosine, sine = math.cos(math.pi / 6.0), math.sin(math.pi / 6.0)
    turn = np.array([[cosine, -sine], [sine, cosine]])
    slip = fem.slide_in_plane(TIMES, x, y, up, mu_static=0.3, mu_kinetic=kinetic)
    turned = fem.slide_in_plane(TIMES, *(turn @ [x, y]), up, mu_static=0.3, mu_kinetic=kinetic)
    np.testing.assert_allclose(turned, slip @ turn.T, atol=1e-12)
    assert np.abs(slip).max() > 0.03


@pytest.mark.parametrize(
    ("seed", "kinetic", "lift"), [(1, 0.3, 0.0), (2, 0.2, 4.0), (3, 0.1, 6.0), (7, 0.2, 0.0)]
)
def test_along_a_line_it_is_the_planar_slider(seed, kinetic, lift):
    along, up = record(seed, 6.0), lift * record(seed + 50, 1.0)
    slip = fem.slide_in_plane(TIMES, 0.6 * along, 0.8 * along, up, mu_static=0.3, mu_kinetic=kinetic)
    floor = FloorAcceleration(
        function=lambda time: float(np.interp(time, TIMES, along)),
        vertical=lambda time: float(np.interp(time, TIMES, up)),
        break_times=tuple(TIMES),
        longest_step=math.inf,
    )
    slider = RigidSlider(mu_static=0.3, mu_kinetic=kinetic, gravity=G)
    expected, _ = simulate_sliding(slider, floor, duration=float(TIMES[-1])).at(TIMES)
    np.testing.assert_allclose(slip, expected[:, None] * [0.6, 0.8], atol=1e-6)
    assert np.abs(expected).max() > 0.01


def test_a_body_that_is_pushed_aside_turns_and_stops_where_it_should():
    """Sliding at v across a constant acceleration G < mu g: the path of a block on an inclined plane.

    With F = mu g, k = F/G and the angle phi from the direction of the push, v sin(phi)/tan^k(phi/2) stays, so that the
    body stops v^2/(4 G (k^2 - 1)) along the push and 2 k v^2/(G (4 k^2 - 1)) across.
    """
    mu, push, slow = 0.3, 1.5, 6.0
    friction = mu * G
    begin = 0.2
    speed = (slow - friction) * begin
    times, (x, y, up) = held([(begin, -slow, 0.0, 0.0), (3.0, 0.0, -push, 0.0)])
    slip = fem.slide_in_plane(times, x, y, up, mu_static=mu)
    ratio = friction / push
    across = 0.5 * speed * begin + 2.0 * ratio * speed**2 / (push * (4.0 * ratio**2 - 1.0))
    along = speed**2 / (4.0 * push * (ratio**2 - 1.0))
    np.testing.assert_allclose(slip[-1], [across, along], rtol=1e-6)


def test_in_flight_nothing_resists_and_a_landing_takes_friction_times_its_velocity():
    """The floor falls with 2 g for 0.1 s and goes on at that velocity: the body flies, lands and slides on."""
    mu, along, drop = 0.2, 4.0, 0.1
    times, (x, y, up) = held([(0.1, -along, 0.0, 0.0), (drop, 0.0, 0.0, -2.0 * G), (1.5, 0.0, 0.0, 0.0)])
    slip = fem.slide_in_plane(times, x, y, up, mu_static=mu)
    speed = (along - mu * G) * 0.1
    # gap g t^2/2 and opening velocity g t after the drop, then free fall to the floor: it closes at sqrt(2) g t
    flight = drop + drop * (1.0 + math.sqrt(2.0))
    left = speed - mu * math.sqrt(2.0) * G * drop
    assert left < 0.0  # so it stops where it lands
    np.testing.assert_allclose(slip[-1], [0.5 * speed * 0.1 + speed * flight, 0.0], atol=1e-7)


def test_the_velocity_at_the_end_is_that_of_the_body_over_its_floor():
    times, accelerations = held([(0.1, 3.0, -4.0, 0.0)])
    velocity = np.zeros(2)
    slide_over(times, accelerations, (0.3, 0.2), G, np.zeros((2, 2)), velocity)
    np.testing.assert_allclose(velocity, (5.0 - 0.2 * G) * 0.1 * np.array([-0.6, 0.8]), rtol=1e-7)
