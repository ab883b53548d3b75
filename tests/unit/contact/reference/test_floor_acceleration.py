import math

import pytest
from floors import half_sine_pulse, one_sine_pulse, rectangular_pulse, sine_floor

from contact.reference.floor_acceleration import FloorAcceleration


def test_each_side_of_a_jump_has_its_own_limit():
    # 0.1 + 0.2 does not fall on a round number: the end must still belong to the pulse seen from before.
    floor = rectangular_pulse(peak=3.0, duration=0.2, delay=0.1)
    before, during, after = floor.segments(0.0, 1.0)
    assert [before.acceleration(t).x for t in (0.0, 0.1)] == [0.0, 0.0]
    assert [during.acceleration(t).x for t in (during.start, 0.2, during.end)] == [3.0, 3.0, 3.0]
    assert [after.acceleration(t).x for t in (after.start, 1.0)] == [0.0, 0.0]
    assert floor.just_after(0.1).x == 3.0
    assert floor.just_after(0.1 + 0.2).x == 0.0


def test_pulses_have_the_shape_of_their_name():
    half, one = half_sine_pulse(peak=2.0, duration=0.6), one_sine_pulse(peak=2.0, duration=0.6)
    assert half.just_after(0.3).x == pytest.approx(2.0)
    assert half.just_after(0.45).x == pytest.approx(2.0 * math.sin(0.75 * math.pi))
    assert one.just_after(0.15).x == pytest.approx(2.0)
    assert one.just_after(0.45).x == pytest.approx(-2.0)
    assert half.just_after(0.7).x == one.just_after(0.7).x == 0.0


def test_a_vertical_motion_adds_its_values_its_breaks_and_its_step():
    floor = rectangular_pulse(peak=3.0, duration=0.2, delay=0.1)
    both = floor.with_vertical(half_sine_pulse(peak=-2.0, duration=0.4, delay=0.2))
    assert both.break_times == (0.1, 0.2, 0.1 + 0.2, 0.2 + 0.4)
    assert both.longest_step == 0.1
    assert both.just_after(0.15) == (3.0, 0.0)
    assert both.just_after(0.4) == pytest.approx((0.0, -2.0))
    assert floor.just_after(0.15) == (3.0, 0.0)


def test_nonsense_is_refused():
    with pytest.raises(ValueError, match="increase"):
        FloorAcceleration(function=math.sin, break_times=(1.0, 1.0), longest_step=0.1)
    with pytest.raises(ValueError, match="finite"):
        FloorAcceleration(function=math.sin, break_times=(math.nan,), longest_step=0.1)
    with pytest.raises(ValueError, match="longest_step"):
        FloorAcceleration(function=math.sin, longest_step=0.0)
    with pytest.raises(ValueError, match="duration"):
        rectangular_pulse(peak=1.0, duration=0.0)
    with pytest.raises(ValueError, match="angular_frequency"):
        sine_floor(amplitude=1.0, angular_frequency=0.0)
