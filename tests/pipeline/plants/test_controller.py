import numpy as np
import pytest

from simgap.plants.case import PlantCase
from simgap.plants.controller import Controller, Gains, tuned


def reference(position=(0.0, 0.0, 0.0), heading=0.0):
    return np.array([[*position, heading]]), np.zeros((1, 4)), np.zeros((1, 4))


def command(racer, reference, rotation=None, body_rate=(0.0, 0.0, 0.0)):
    level = np.eye(3)[None] if rotation is None else rotation
    return Controller(racer).command(
        reference, np.zeros((1, 3)), np.zeros((1, 3)), level, np.array([body_rate]), np.zeros((1, 4))
    )


def wrench(racer, speeds):
    thrust = racer.thrust_coefficient * speeds[0] ** 2
    places = np.array(racer.rotor_positions)
    yaw = racer.torque_coefficient * (np.array(racer.rotor_directions) * speeds[0] ** 2).sum()
    return thrust.sum(), (places[:, 1] * thrust).sum(), -(places[:, 0] * thrust).sum(), yaw


def test_hover_in_place_takes_hover_rotor_speed(racer):
    np.testing.assert_allclose(command(racer, reference()), racer.hover_rotor_speed)


def test_it_pushes_towards_where_it_is_to_go(racer):
    thrust, *_ = wrench(racer, command(racer, reference((0.0, 0.0, 0.5))))
    assert thrust > racer.mass * racer.gravity
    _, roll, pitch, yaw = wrench(racer, command(racer, reference((0.5, 0.0, 0.0))))
    assert pitch > 0
    np.testing.assert_allclose([roll, yaw], 0.0, atol=1e-12)
    _, roll, pitch, yaw = wrench(racer, command(racer, reference((0.0, 0.5, 0.0))))
    assert roll < 0
    np.testing.assert_allclose([pitch, yaw], 0.0, atol=1e-12)
    _, roll, pitch, yaw = wrench(racer, command(racer, reference(heading=0.2)))
    assert yaw > 0
    np.testing.assert_allclose([roll, pitch], 0.0, atol=1e-12)


def test_it_brakes_a_turn(racer):
    _, roll, _, _ = wrench(racer, command(racer, reference(), body_rate=(1.0, 0.0, 0.0)))
    assert roll < 0


def test_commands_stay_within_what_motors_can_do(racer):
    speeds = command(racer, reference((0.0, 0.0, 1000.0)))
    assert (speeds <= racer.motor_speed_max).all()
    assert (command(racer, reference((0.0, 0.0, -1000.0))) > 0).all()


def test_a_trimmed_autopilot_takes_up_what_stays_wrong(racer):
    gains = tuned(PlantCase(autopilot="trimmed"), racer)
    controller = Controller(racer, gains, step=0.01)
    target, (still, zero) = reference((0.0, 0.0, 0.1))[0], reference()[1:]
    speeds = [
        controller.command(
            (target, still, zero), zero[:, :3], zero[:, :3], np.eye(3)[None], zero[:, :3], np.zeros((1, 4))
        )
        for _ in range(50)
    ]
    gained = [wrench(racer, speed)[0] for speed in speeds]
    assert (np.diff(gained) > 0).all()
    rise = racer.mass * 0.01 * gains.position_integral * 0.1
    np.testing.assert_allclose(np.diff(gained), rise, rtol=1e-6)


def test_late_motors_and_heavy_rotors_are_flown_with_care(racer):
    plain, late, heavy = (
        tuned(PlantCase(effects=effects, autopilot="trimmed"), racer)
        for effects in ({}, {"command_delay": 0.05}, {"rotor_inertia_torque": 1e-5})
    )
    assert late.body_rate * 0.05 == pytest.approx(0.6)
    assert plain.body_rate == Gains().body_rate
    assert plain.yaw_cut_off == np.inf
    assert heavy.yaw_cut_off == 2 * racer.torque_coefficient * racer.hover_rotor_speed / 1e-5
    assert tuned(PlantCase(effects={"motor_lag": 0.05}), racer) == Gains()
