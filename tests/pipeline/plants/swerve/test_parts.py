"""Tyres, chassis and scrubbing patches against what is known of them exactly."""

import math

import numpy as np
import pytest

from simgap.plants.concealment import Concealed
from simgap.plants.swerve.chassis import WHEEL_SHARE, chassis_of
from simgap.plants.swerve.effects import CONCEALABLE, OUTSIDE
from simgap.plants.swerve.steering import scrub_of
from simgap.plants.swerve.tyres import CREEPING, Tyres

STEP = 1e-3


def chassis(robot, **effects):
    named = {name.replace("_at_", "@"): values for name, values in effects.items()}
    return chassis_of(Concealed(named, CONCEALABLE, {}), Concealed({}, OUTSIDE, {}), robot, runs=1)


def driven(body, angle, torque, steps=1000):
    for _ in range(steps):
        body.advance(np.asarray(angle, dtype=float)[None], np.full((1, 4), torque), STEP)
    return body


def test_an_even_pull_accelerates_the_whole_mass(robot):
    body = driven(chassis(robot), np.full(4, 0.3), 1.0)
    speed = 4.0 * 1.0 / robot.wheel_radius / robot.mass
    np.testing.assert_allclose(body.twist[0], speed * np.array([np.cos(0.3), np.sin(0.3), 0.0]), atol=2e-3)


def test_wheels_on_a_circle_turn_the_whole_inertia(robot):
    places = np.array(robot.module_positions)
    body = driven(chassis(robot), np.arctan2(places[:, 0], -places[:, 1]), 0.5)
    lever = np.hypot(*places[0])
    assert body.twist[0, 2] == pytest.approx(4 * 0.5 / robot.wheel_radius * lever / robot.inertia, rel=2e-3)


def test_a_slope_pulls_downhill_whichever_way_the_robot_faces(robot):
    body = chassis(robot, slope_at_chassis={"rise_x": 0.1, "rise_y": 0.0})
    body.heading[:] = 0.5 * np.pi  # facing left, downhill is to its left as well
    driven(body, np.full(4, 0.5 * np.pi), 0.0, steps=500)
    assert body.twist[0, 1] == pytest.approx(0.1 * robot.gravity * 0.5, rel=5e-3)


def test_a_turning_robot_keeps_its_energy_without_torque(robot):
    places = np.array(robot.module_positions)
    twist = np.array([0.8, 0.5, 1.5])
    angle = np.arctan2(twist[1] + twist[2] * places[:, 0], twist[0] - twist[2] * places[:, 1])
    body = chassis(robot)
    body.twist[:] = twist
    body.rolling[:] = np.hypot(twist[1] + twist[2] * places[:, 0], twist[0] - twist[2] * places[:, 1])
    driven(body, angle, 0.0, steps=1000)
    np.testing.assert_allclose(body.twist[0], twist, rtol=5e-3)


def test_no_wheel_pulls_harder_than_its_grip(robot):
    effects = {"wheel_slip_at_drive": {"friction_coefficient": 0.4, "stiffness": 40.0, "height": 0.0}}
    body = driven(chassis(robot, **effects), np.zeros(4), 6.0)
    assert body.twist[0, 0] == pytest.approx(0.4 * robot.gravity / (1.0 - WHEEL_SHARE), rel=0.01)
    assert body.rolling[0, 0] > 2 * body.twist[0, 0]


def test_grip_is_shared_along_and_across():
    tyres = Tyres(friction=0.8, stiffness=40.0, height=0.0)
    random = np.random.default_rng(0)
    slip, loads = random.normal(0.0, 1.0, (2, 50, 4)), np.full((50, 4), 100.0)
    force = tyres.damping(slip, np.ones((50, 4)), loads) * slip
    assert (np.hypot(*force) < 80.0).all()
    np.testing.assert_allclose(force[0] * slip[1], force[1] * slip[0])
    small = tyres.damping(1e-6 * slip, np.zeros((50, 4)) + 10.0, loads)[0]
    np.testing.assert_allclose(small, 40.0 * 100.0 / math.hypot(10.0, 0.15))


def test_a_pulling_wheel_creeps_as_much_as_its_compliance_says(robot):
    """At speed; slip follows the pull less what speeds the wheel itself up."""
    body = driven(chassis(robot, tyre_creep_at_drive={"compliance": 0.04, "height": 0.0}), np.zeros(4), 2.0)
    slip = body.rolling[0] - body.twist[0, 0]
    pull = 2.0 / robot.wheel_radius * (1.0 - WHEEL_SHARE)
    share = 0.04 * pull / (0.25 * robot.mass * robot.gravity)
    np.testing.assert_allclose(slip / np.hypot(body.rolling[0], CREEPING), share, rtol=0.02)


def test_wheels_that_point_elsewhere_hold_with_the_side_force_of_their_slip_angle():
    tyres = Tyres(friction=math.inf, stiffness=0.0, height=0.0, cornering=15.0)
    angle, rolling, loads = 0.05, np.full((1, 4), 3.0), np.full((1, 4), 100.0)
    slip = np.stack((np.zeros_like(rolling), math.tan(angle) * rolling))
    _, side = tyres.damping(slip, rolling, loads)
    np.testing.assert_allclose(side * slip[1], 15.0 * loads * math.tan(angle) * 3.0 / math.hypot(3.0, 0.15))
    well_aligned = Tyres(friction=math.inf, stiffness=0.0, height=0.0)
    assert (side < 0.1 * well_aligned.damping(slip, rolling, loads)[1]).all()


def test_braking_shifts_load_forward_and_keeps_its_sum(robot):
    modules = np.array(robot.module_positions)
    tyres = Tyres(friction=0.8, stiffness=40.0, height=0.2)
    loads = tyres.loads(robot.mass * robot.gravity, robot.mass, np.array([[-2.0, 0.0]]), modules)[0]
    assert loads[0] == loads[1] > loads[2] == loads[3]
    assert loads.sum() == pytest.approx(robot.mass * robot.gravity)


def test_scrub_holds_at_rest_and_fades_as_the_wheel_rolls(robot):
    effects = Concealed({"scrub_torque@steer": {"level": 2.0, "patch_radius": 0.02}}, CONCEALABLE, {})

    def settled(turning, rolling):
        scrub = scrub_of(effects, robot, 1.0, axes=1)
        for _ in range(2000):
            torque = scrub.torque(np.array([turning]), np.array([rolling]), STEP)
        return torque[0]

    assert settled(3.0, 0.0) == pytest.approx(-2.0, rel=1e-6)
    assert settled(-3.0, 0.08) == pytest.approx(2.0 * 0.06 / 0.1, rel=1e-4)
    assert abs(settled(3.0, 3.0)) < 0.05
    assert scrub_of(Concealed({}, CONCEALABLE, {}), robot, 1.0, axes=1) is None
