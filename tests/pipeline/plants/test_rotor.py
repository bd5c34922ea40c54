import numpy as np
import pytest

from simgap.plants.rotor import AIR_DENSITY, Rotor

ROTOR = Rotor(1.5e-6, radius=0.0635, lateral_scale=1.0, axial_share=1.0, in_plane_share=1.0)
SPEED = np.array([800.0, 1200.0, 1800.0])


def settled(speed, velocity):
    velocity = np.broadcast_to(np.asarray(velocity, dtype=float), (*speed.shape, 3))
    return ROTOR.forces(speed, velocity, ROTOR.still_inflow(speed), steps=30)


def test_thrust_in_still_air_is_quadratic_in_speed():
    thrust, in_plane, _ = settled(SPEED, [0.0, 0.0, 0.0])
    np.testing.assert_allclose(thrust, 1.5e-6 * SPEED**2, rtol=1e-12)
    np.testing.assert_array_equal(in_plane, 0.0)


@pytest.mark.parametrize("velocity", [(5.0, 0.0, 0.0), (0.0, 0.0, 3.0), (2.0, -6.0, 1.0), (4.0, 1.0, -2.0)])
def test_blades_and_momentum_agree_on_the_thrust(velocity):
    thrust, _, inflow = settled(SPEED, velocity)
    induced = inflow[1]
    resultant = np.hypot(np.hypot(velocity[0], velocity[1]), velocity[2] + induced)
    np.testing.assert_allclose(2 * AIR_DENSITY * ROTOR.area * induced * resultant, thrust, rtol=1e-9)


def test_climbing_costs_thrust_and_flying_forward_gains_it():
    hover = settled(SPEED, (0.0, 0.0, 0.0))[0]
    assert (settled(SPEED, (0.0, 0.0, 2.0))[0] < hover).all()
    assert (settled(SPEED, (0.0, 0.0, -2.0))[0] > hover).all()
    assert (settled(SPEED, (6.0, 0.0, 0.0))[0] > hover).all()


def test_in_plane_force_opposes_the_airspeed_whatever_its_direction():
    along = settled(SPEED, (4.0, 0.0, 1.0))[1]
    across = settled(SPEED, (0.0, 4.0, 1.0))[1]
    assert (along[:, 0] < 0).all()
    np.testing.assert_allclose(along[:, 1], 0.0, atol=1e-15)
    np.testing.assert_allclose(across[:, 1], along[:, 0])


def test_two_newton_steps_from_the_last_inflow_are_enough_at_a_thousand_a_second():
    speed = np.array([1200.0])
    inflow = ROTOR.still_inflow(speed)
    for step in range(500):  # accelerating at 20 m/s²
        velocity = np.array([[0.02 * step, 0.0, 0.005 * step]])
        thrust, _, inflow = ROTOR.forces(speed, velocity, inflow)
    np.testing.assert_allclose(thrust, settled(speed, velocity[0])[0], rtol=1e-9)
