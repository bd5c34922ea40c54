import numpy as np
import pytest
import torch

from simgap.plants.case import PlantCase
from simgap.plants.design import PROBE_SPEED, design
from simgap.platforms.quadrotor_mechanism import QuadrotorMechanism

ALL = {"rotor_drag": 0.4, "axial_inflow": 0.3, "translational_lift": 0.02, "body_drag": 0.04}


def some_states(seed=0, count=50):
    random = np.random.default_rng(seed)
    velocity = random.uniform(-6.0, 6.0, (count, 3)) * [1.0, 1.0, 0.3]
    return velocity, random.uniform(-4.0, 4.0, (count, 3)), random.uniform(700.0, 2000.0, (count, 4))


def test_with_everything_off_it_is_the_nominal_mechanism(racer):
    velocity, body_rate, speed = some_states()
    airframe = design(racer, PlantCase())
    force, torque, _ = airframe.wrench(velocity, body_rate, speed, airframe.rotor.still_inflow(speed))
    mechanism = QuadrotorMechanism(racer)
    nominal = mechanism.wrench({"rotor_speed": torch.from_numpy(speed)}, mechanism.constants())
    for index, axis in enumerate("xyz"):
        np.testing.assert_allclose(force[:, index], nominal[f"force_{axis}"], rtol=1e-10, atol=1e-12)
        np.testing.assert_allclose(torque[:, index], nominal[f"torque_{axis}"], rtol=1e-10, atol=1e-12)


def test_strengths_are_reached_at_hover(racer):
    hover, still = np.full(4, racer.hover_rotor_speed), np.zeros(3)

    def added(effect, velocity):
        airframe = design(racer, PlantCase(effects={effect: ALL[effect]}))
        return (
            airframe.settled(np.array(velocity), still, hover)[0] - airframe.settled(still, still, hover)[0]
        )

    assert -added("rotor_drag", (0.1, 0.0, 0.0))[0] / 0.1 == pytest.approx(0.4, rel=1e-6)
    assert -added("axial_inflow", (0.0, 0.0, 0.01))[2] / 0.01 == pytest.approx(0.3, rel=0.02)
    lift = added("translational_lift", (PROBE_SPEED, 0.0, 0.0))[2] / PROBE_SPEED**2
    assert lift == pytest.approx(0.02, rel=0.02)
    drag = added("body_drag", (0.0, 3.0, 0.0))[1] / 9.0
    assert drag == pytest.approx(-0.04, rel=1e-6)


@pytest.mark.parametrize("effect", ALL)
def test_each_effect_can_be_taken_away_again(racer, effect):
    velocity, body_rate, speed = some_states()
    alone = design(racer, PlantCase(effects={effect: ALL[effect]}))
    np.testing.assert_allclose(
        alone.without(effect).settled(velocity, body_rate, speed)[0],
        design(racer, PlantCase()).settled(velocity, body_rate, speed)[0],
        rtol=1e-10,
    )


def test_a_mirrored_state_gives_the_mirrored_force(racer):
    """Left and right exchanged: rotors 1 and 4, 2 and 3 swap; y of vectors and x, z of rates change sign."""
    airframe = design(racer, PlantCase(effects=ALL, arm=1.0))
    velocity, body_rate, speed = some_states()
    force, torque = airframe.settled(velocity, body_rate, speed)
    mirrored_force, mirrored_torque = airframe.settled(
        velocity * [1, -1, 1], body_rate * [-1, 1, -1], speed[:, [3, 2, 1, 0]]
    )
    np.testing.assert_allclose(mirrored_force, force * [1, -1, 1], rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(mirrored_torque, torque * [-1, 1, -1], rtol=1e-9, atol=1e-12)


def test_rotors_that_feel_the_turning_resist_it(racer):
    airframe = design(racer, PlantCase(effects=ALL, arm=1.0))
    _, body_rate, speed = some_states()
    still, even = np.zeros_like(body_rate), np.full_like(speed, 1200.0)
    torque = airframe.settled(still, body_rate, even)[1]
    without = airframe.without("angular_drag").settled(still, body_rate, even)[1]
    np.testing.assert_allclose(without, 0.0, atol=1e-12)
    assert ((torque * body_rate).sum(axis=-1) < 0).all()


def test_drag_takes_energy_from_the_motion(racer):
    velocity, _, speed = some_states()
    still = np.zeros_like(velocity)
    for effect in ("rotor_drag", "body_drag", "axial_inflow"):
        airframe = design(racer, PlantCase(effects={effect: ALL[effect]}))
        added = airframe.settled(velocity, still, speed)[0]
        added = added - airframe.without(effect).settled(velocity, still, speed)[0]
        assert ((added * velocity).sum(axis=-1) <= 1e-12).all()


def test_decoys_change_the_plant_and_not_the_platform(racer):
    airframe = design(racer, PlantCase(effects={"mass_error": 1.2, "thrust_coefficient_error": 0.9}))
    assert airframe.mass == pytest.approx(1.2 * racer.mass)
    still, speed = np.zeros(3), np.full(4, 1000.0)
    lift = airframe.settled(still, still, speed)[0][2]
    assert lift == pytest.approx(4 * 0.9 * racer.thrust_coefficient * 1e6 / (1.2 * racer.mass))


def test_near_the_floor_thrust_grows_as_cheeseman_and_bennett_say(racer):
    airframe = design(racer, PlantCase(effects={"ground_effect": 1e-3}))
    still, speed = np.zeros((3, 3)), np.full((3, 4), 1200.0)
    height = np.array([0.15, 0.3, 3.0])
    near, far = (airframe.settled(still, still, speed, at)[0][:, 2] for at in (height, None))
    np.testing.assert_allclose(near / far, 1.0 / (1.0 - 1e-3 / height**2))
    touching = airframe.settled(still, still, speed, np.zeros(3))[0]
    assert np.isfinite(touching).all()
    moving = airframe.settled(still + np.array([30.0, 0.0, 0.0]), still, speed, height)[0]
    assert moving[0, 2] < airframe.settled(still, still, speed, height)[0][0, 2]


def test_thrust_beside_the_centre_of_mass_turns_the_machine(racer):
    offset = {"offset_x": 0.01, "offset_y": -0.02}
    airframe = design(racer, PlantCase(effects={"center_of_mass_offset": offset}))
    still, speed = np.zeros(3), np.full(4, 1200.0)
    thrust = 4 * racer.thrust_coefficient * 1200.0**2
    np.testing.assert_allclose(
        airframe.settled(still, still, speed)[1], [0.02 * thrust, 0.01 * thrust, 0.0], atol=1e-12
    )


def test_a_weak_rotor_lifts_and_twists_less(racer):
    whole, weak = (design(racer, PlantCase(effects=case)) for case in ({}, {"rotor_fault": {"loss_3": 0.25}}))
    speed = np.array([0.0, 0.0, 1000.0, 0.0]) + 1e-6
    still = np.zeros(3)
    for full, less in zip(whole.settled(still, still, speed), weak.settled(still, still, speed), strict=True):
        np.testing.assert_allclose(less, 0.75 * full, atol=1e-9)


def test_flapping_lifts_the_side_that_meets_the_air(racer):
    airframe = design(racer, PlantCase(effects={"blade_flapping_moment": 0.004}))
    hover, still = np.full(4, racer.hover_rotor_speed), np.zeros(3)
    for velocity, expected in (((0.1, 0.0, 0.0), (0.0, -4e-4, 0.0)), ((0.0, 0.1, 0.0), (4e-4, 0.0, 0.0))):
        force, torque = airframe.settled(np.array(velocity), still, hover)
        np.testing.assert_allclose(torque, expected, rtol=1e-3, atol=1e-9)
        np.testing.assert_allclose(force[:2], 0.0, atol=1e-12)


def test_air_that_resists_turning_takes_its_energy(racer):
    airframe = design(racer, PlantCase(effects={"angular_drag": 2e-3}))
    _, body_rate, _ = some_states()
    still, even = np.zeros_like(body_rate), np.full((50, 4), 1200.0)
    torque = airframe.settled(still, body_rate, even)[1]
    assert ((torque * body_rate).sum(axis=-1) < 0).all()
    slow = airframe.settled(np.zeros(3), np.array([0.0, 1e-3, 0.0]), np.full(4, 1200.0))[1]
    assert slow[1] == pytest.approx(-2e-3 * 1e-3, rel=1e-3)
    without = airframe.without("angular_drag").settled(still, body_rate, even)[1]
    np.testing.assert_allclose(without, 0.0, atol=1e-12)
