import numpy as np
import pytest

from simgap.plants.airframe import Airframe
from simgap.plants.case import PlantCase
from simgap.plants.concealable import OUTSIDE
from simgap.plants.design import design
from simgap.plants.outside import (
    SHOWS_IN,
    ArmResonance,
    HeadingTorque,
    Moment,
    ShiftingMass,
    ThrustFade,
    VortexRing,
    disturbances,
)

LIFT, NO_TORQUE = np.array([[0.0, 0.0, 9.81]]), np.zeros((1, 3))


@pytest.fixture
def airframe(racer) -> Airframe:
    return design(racer, PlantCase())


def moment(velocity=(0.0, 0.0, 0.0), rotation=None, speed=1168.0, index=0):
    turned = np.eye(3)[None] if rotation is None else rotation
    return Moment(index, turned, np.array([velocity]), np.full((1, 4), speed))


def turned_about(axis, angle):
    rotation = np.eye(3)
    a, b = [index for index in range(3) if index != axis]
    rotation[a, a] = rotation[b, b] = np.cos(angle)
    sign = -1.0 if axis != 1 else 1.0
    rotation[a, b], rotation[b, a] = sign * np.sin(angle), -sign * np.sin(angle)
    return rotation[None]


def test_rotors_lose_thrust_only_where_they_sink_into_their_own_wake(airframe):
    ring = VortexRing(0.3, airframe, np.zeros((1, 1)))
    induced = airframe.rotor.still_inflow(np.array([1168.0]))[0, 0]

    def left(velocity):
        return ring(moment(velocity), LIFT, NO_TORQUE)[0][0, 2] / 9.81

    assert left((0.0, 0.0, -induced)) == pytest.approx(0.7)
    assert left((0.0, 0.0, 0.5 * induced)) > 0.999
    assert left((0.0, 0.0, -3.0 * induced)) > 0.999
    assert left((3.0 * induced, 0.0, -induced)) > 0.999


def test_its_loss_flutters(airframe):
    ring = VortexRing(0.3, airframe, np.array([[1.0], [-1.0]]))
    induced = airframe.rotor.still_inflow(np.array([1168.0]))[0, 0]
    lost = [9.81 - ring(moment((0, 0, -induced), index=i), LIFT, NO_TORQUE)[0][0, 2] for i in (0, 1)]
    np.testing.assert_allclose(lost, 9.81 * 0.3 * np.array([1.5, 0.5]))


def test_a_loose_weight_goes_to_the_lower_side(airframe):
    mass = ShiftingMass(0.01, airframe, 1e-3)
    np.testing.assert_allclose(mass(moment(), LIFT, NO_TORQUE)[1], 0.0, atol=1e-15)
    nose_down = moment(rotation=turned_about(1, 1.2))
    for _ in range(3000):
        _, torque = mass(nose_down, LIFT, NO_TORQUE)
    assert 0.95 * 0.01 < mass.place[0, 0] < 0.01
    np.testing.assert_allclose(torque, [[0.0, mass.place[0, 0] * airframe.mass * 9.81, 0.0]], atol=1e-12)


def test_motors_fade_as_they_heat_and_no_more_than_they_may():
    fade = ThrustFade(0.2, 1168.0, 0.01)
    lifts = [fade(moment(), LIFT, NO_TORQUE)[0][0, 2] for _ in range(6000)]
    assert lifts[0] == pytest.approx(9.81, rel=1e-3)
    assert (np.diff(lifts) <= 0).all()
    assert lifts[-1] == pytest.approx(9.81 * (1.0 - 0.2 * np.tanh(1.0)), rel=1e-3)


@pytest.mark.parametrize("heading", [0.0, 1.0, -2.0, 3.0])
def test_a_magnet_turns_with_the_sine_of_the_heading(heading):
    torque = HeadingTorque(0.01)(moment(rotation=turned_about(2, heading)), LIFT, NO_TORQUE)[1]
    np.testing.assert_allclose(torque, [[0.0, 0.0, 0.01 * np.sin(heading)]], atol=1e-15)


@pytest.mark.parametrize(("frequency", "gain"), [(2.0, 1.0), (18.0, 1.0 / 0.12), (100.0, 0.033)])
def test_an_arm_passes_slow_torques_swells_at_its_frequency_and_stands_still_above(frequency, gain):
    step = 1e-4
    arm, seen = ArmResonance(1.0, 18.0, step), []
    for index in range(30000):
        torque = np.sin(2 * np.pi * frequency * index * step) * np.ones((1, 3))
        seen.append(arm(moment(), LIFT, torque)[1][0, 0])
    assert np.max(np.abs(seen[-15000:])) == pytest.approx(gain, rel=0.06)


def test_only_what_is_asked_for_disturbs(racer, airframe):
    def built(**outside):
        case = PlantCase(outside=outside, runs=1)
        return disturbances(case, airframe, racer.hover_rotor_speed, 5, 1e-3, np.random.default_rng(0))

    assert built() == []
    (fade,) = built(thrust_fade=0.1)
    assert fade.depth == 0.1
    everything = {
        name: {k: min(q.default, q.high) for k, q in table.items()} for name, table in OUTSIDE.items()
    }
    everything["gusts"] = {"speed": 0.0}
    assert len(built(**everything)) == len(OUTSIDE) - 1


def test_each_says_where_it_shows():
    assert set(SHOWS_IN) == set(OUTSIDE)
