import pytest

from contact.reference.rigid_block import RigidBlock


def test_seed_paper_box_and_stack():
    # p = sqrt(3g/(4R)), e = 1 - 1.5 sin^2 al with g = 9.81 for 1.1 x 1.0 m and four of them stacked.
    box = RigidBlock.homogeneous(width=1.1, height=1.0)
    stack = RigidBlock.homogeneous(width=1.1, height=4.0)
    assert box.frequency_parameter == pytest.approx(3.14617, abs=5e-6)
    assert stack.frequency_parameter == pytest.approx(1.88337, abs=5e-6)
    assert box.housner_restitution == pytest.approx(0.17873, abs=5e-6)
    assert stack.housner_restitution == pytest.approx(0.89454, abs=5e-6)
    assert stack.uplift_acceleration == pytest.approx(9.81 * 1.1 / 4.0, rel=1e-14)


def test_restitution_keeps_angular_momentum_about_the_new_corner():
    # I_O w+ = (I_G + M (H^2 - B^2)) w-: moment of momentum of a body that turned about the old corner.
    block = RigidBlock(half_width=0.4, centroid_height=1.1, gravity=9.81, inertia_ratio=1.6)
    inertia = 1.6 * block.radius**2
    central = inertia - block.radius**2
    assert block.housner_restitution == pytest.approx((central + 1.1**2 - 0.4**2) / inertia, rel=1e-14)


def test_overturning_energy_keeps_its_digits_for_a_needle():
    block = RigidBlock(half_width=1e-6, centroid_height=1.0, gravity=10.0)
    assert block.overturning_energy == pytest.approx(10.0 * 0.5e-12, rel=1e-10)
