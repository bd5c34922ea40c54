"""The masses against closed solutions."""

import numpy as np
import pytest

from simgap.plants.concealment import Concealed
from simgap.plants.joint.axis import Coupling, axis_of
from simgap.plants.joint.case import JointCase
from simgap.plants.joint.effects import CONCEALABLE, OUTSIDE
from simgap.platforms import Joint

MACHINE = Joint(inertia=0.5)
STEP = 1e-3


def moved(effects, outside=(), start=(0.0, 0.0), effort=0.0, steps=2000, machine=MACHINE):
    """Return position and velocity (steps, bodies) of one run under a constant effort."""
    case = JointCase(effects=effects, outside=dict(outside), runs=1)
    size = case.size(machine)
    concealed = Concealed(case.effects, CONCEALABLE, size), Concealed(case.outside, OUTSIDE, size)
    axis = axis_of(*concealed, machine, case, (np.full(1, start[0]), np.full(1, start[1])))
    push = np.full(1, effort)
    axis.feel(push)
    path = []
    for _ in range(steps):
        axis.travel(STEP)
        axis.push(push, STEP)
        path.append((axis.position[:, 0], axis.velocity[:, 0]))
    positions, velocities = (np.stack(part) for part in zip(*path, strict=True))
    return positions, velocities, axis


TIMES = STEP * np.arange(1, 2001)


def test_a_push_alone_accelerates_evenly():
    position, velocity, _ = moved({}, effort=2.0)
    np.testing.assert_allclose(velocity[:, 0], 4.0 * TIMES, rtol=1e-9)
    np.testing.assert_allclose(position[:, 0], 2.0 * TIMES**2, rtol=1e-9)


def test_a_spring_swings():
    position, *_ = moved({"linear_stiffness": {"stiffness": 200.0}}, start=(0.1, 0.0))
    np.testing.assert_allclose(position[:, 0], 0.1 * np.cos(20.0 * TIMES), atol=1e-4)


def test_viscous_friction_slows_exponentially():
    _, velocity, _ = moved({"viscous_friction": {"coefficient": 1.5}}, start=(0.0, 2.0))
    np.testing.assert_allclose(velocity[:, 0], 2.0 * np.exp(-3.0 * TIMES), atol=1e-5)


def test_quadratic_friction_slows_as_a_hyperbola():
    _, velocity, _ = moved({"quadratic_friction": {"coefficient": 0.5}}, start=(0.0, 2.0))
    np.testing.assert_allclose(velocity[:, 0], 2.0 / (1.0 + 2.0 * TIMES), atol=1e-5)


def test_dry_friction_slows_evenly_and_then_holds():
    _, velocity, _ = moved({"coulomb_friction": {"level": 1.0}}, start=(0.0, 2.0))
    sliding = TIMES < 0.9
    np.testing.assert_allclose(velocity[sliding, 0], 2.0 - 2.0 * TIMES[sliding], atol=0.01)
    assert np.abs(velocity[TIMES > 1.3]).max() < 0.01


@pytest.mark.parametrize(
    ("effects", "energy"),
    [
        ({"cubic_stiffness": {"stiffness": 300.0}}, lambda x: 75.0 * x**4),
        ({"gravity_load": {"sine": 4.0, "cosine": 0.0}}, lambda x: -4.0 * np.cos(x)),
        ({"constant_load": {"load": 3.0}}, lambda x: -3.0 * x),
    ],
)
def test_springs_and_weights_keep_the_energy(effects, energy):
    position, velocity, _ = moved(effects, start=(0.4, 0.5))
    total = 0.25 * velocity[:, 0] ** 2 + energy(position[:, 0])
    np.testing.assert_allclose(total, total[0], atol=2e-3 * np.ptp(energy(position[:, 0])))


def test_teeth_transmit_nothing_inside_the_gap_and_never_pull():
    coupling = Coupling(gap=0.1, stiffness=100.0, damping=1.0)
    twist, rate = np.array([-0.049, 0.0, 0.049, 0.06, 0.06, -0.06]), np.array([9.0, 9.0, 9.0, 0.0, -9.0, 0.0])
    np.testing.assert_allclose(coupling.effort(twist, rate), [0.0, 0.0, 0.0, 1.0, 0.0, -1.0], atol=1e-12)


def test_two_bodies_keep_their_momentum_and_lose_energy_on_the_teeth():
    effects = {"backlash": {"gap": 0.05, "motor_inertia_share": 0.3}}
    _, velocity, axis = moved(effects, effort=2.0)
    momentum = velocity @ axis.inertia[:, 0]
    np.testing.assert_allclose(momentum, 2.0 * TIMES, rtol=1e-9)
    twist = axis.position[0, 0] - axis.position[1, 0]
    assert 0.025 < twist < 0.026  # the motor pushes on one face
    assert velocity[20, 1] == 0.0  # the load has not felt anything while the gap was crossed


def test_a_soft_shaft_rings_at_its_frequency():
    """At a motor's share of a quarter, against each other the two swing twice as fast as against a held motor."""
    effects = {"flexible_coupling": {"frequency": 5.0, "damping_ratio": 0.0, "motor_inertia_share": 0.25}}
    position, *_ = moved(effects, effort=1.0, steps=4000)
    twist = position[:, 0] - position[:, 1]
    lines = np.abs(np.fft.rfft(twist - twist.mean()))
    assert np.fft.rfftfreq(4000, STEP)[np.argmax(lines)] == pytest.approx(10.0, abs=0.3)


def test_a_stop_stops():
    position, *_ = moved({}, {"hard_stop": {"position": 0.3}}, effort=2.0)
    assert position.max() < 0.31
