"""Design of the true plant from a platform file and a case."""

import math
from dataclasses import replace

import numpy as np

from simgap.plants.airframe import Airframe
from simgap.plants.case import PlantCase
from simgap.plants.rotation import Array
from simgap.plants.rotor import AIR_DENSITY, Rotor
from simgap.platforms import Quadrotor

# Static thrust over density · disc area · tip speed², such that the thrust coefficients of a 5-inch
# racing propeller and of a Crazyflie's give their 127 mm and 50 mm: no platform file has the radius.
STATIC_THRUST_COEFFICIENT = 0.025

PROBE_SPEED = 5.0  # m/s, at which the gain of thrust in plane is set; elsewhere the plant goes its own way


def design(platform: Quadrotor, case: PlantCase) -> Airframe:
    """Return the airframe in which the case's effects have their strengths at hover.

    Strengths set what the blades and the frame are like; what they amount to in flight is for `truth` to say.
    """
    thrust_coefficient = platform.thrust_coefficient * case.strength("thrust_coefficient_error")
    mass = platform.mass * case.strength("mass_error")
    disc = platform.thrust_coefficient / (STATIC_THRUST_COEFFICIENT * AIR_DENSITY * math.pi)
    airframe = Airframe(
        mass=mass,
        inertia=np.array(platform.inertia) * case.strength("inertia_error"),
        rotor_positions=np.array(platform.rotor_positions),
        rotor_directions=np.array(platform.rotor_directions, dtype=float),
        torque_coefficient=platform.torque_coefficient * case.strength("torque_coefficient_error"),
        rotor=Rotor(thrust_coefficient, radius=disc**0.25),
        drag_area=2.0 * mass * case.strength("body_drag") / AIR_DENSITY,
        arm=case.arm,
        gravity=platform.gravity,
        center=np.array([*(case.strength("center_of_mass_offset", f"offset_{axis}") for axis in "xy"), 0.0]),
        lift_share=_lift_shares(case),
        lean=_leans(platform, case.strength("yaw_trim")),
        ground_area=case.strength("ground_effect"),
        turning_resistance=case.strength("angular_drag"),
    )
    return _with_rotor_effects(airframe, platform.hover_rotor_speed, case)


def _lift_shares(case: PlantCase) -> Array:
    """Return each rotor's thrust over that of an even and whole one, (4,)."""
    excess = np.array([case.strength("rotor_thrust_spread", f"excess_{rotor}") for rotor in range(1, 4)])
    loss = np.array([case.strength("rotor_fault", f"loss_{rotor}") for rotor in range(1, 5)])
    return (1.0 + np.append(excess, -excess.sum())) * (1.0 - loss)


def _leans(platform: Quadrotor, imbalance: float) -> Array:
    """Return how far motors lean about their arms, all one way round, such that thrust yaws the machine, (4, 2).

    Args:
        platform: for the rotors' places, and the torque per thrust that the imbalance multiplies.
        imbalance: of the yaw torque, over the reaction torques of all rotors.
    """
    places = np.array(platform.rotor_positions)[:, :2]
    torque_per_thrust = imbalance * platform.torque_coefficient / platform.thrust_coefficient  # m
    around = np.stack((-places[:, 1], places[:, 0]), axis=-1)
    return torque_per_thrust * around / (places**2).sum(axis=-1, keepdims=True)


def _with_rotor_effects(airframe: Airframe, hover: float, case: PlantCase) -> Airframe:
    """Scale each effect of the rotors so that at hover rotor speed it has the wanted strength."""
    small = 0.1  # m/s
    drag = -_gained(airframe, hover, "lateral_scale", (small, 0.0, 0.0))[0] / small
    climb = -_gained(airframe, hover, "axial_share", (0.0, 0.0, small))[2] / small
    lift = _gained(airframe, hover, "in_plane_share", (PROBE_SPEED, 0.0, 0.0))[2] / PROBE_SPEED**2
    spinning = np.array([hover])
    still = airframe.rotor.still_inflow(spinning)[0]
    rigid = replace(airframe.rotor, hub_stiffness=1.0)
    moment = 4.0 * rigid.hub_moment(spinning, still, np.zeros(1)).item()
    rotor = replace(
        airframe.rotor,
        lateral_scale=case.strength("rotor_drag") / drag,
        axial_share=case.strength("axial_inflow") / climb,
        in_plane_share=math.sqrt(case.strength("translational_lift") / lift),
        hub_stiffness=case.strength("blade_flapping_moment") / moment,
    )
    return replace(airframe, rotor=rotor)


def _gained(
    airframe: Airframe, hover: float, switch: str, velocity: tuple[float, float, float]
) -> np.ndarray:
    """Return the specific force that a full effect of the rotors adds at hover rotor speed, m/s²."""
    moving = np.array(velocity)
    speed = np.full(4, hover)
    whole = np.ones(4)
    full = replace(airframe, rotor=replace(airframe.rotor, **{switch: 1.0}), drag_area=0.0, lift_share=whole)
    return full.settled(moving, np.zeros(3), speed)[0] - full.settled(np.zeros(3), np.zeros(3), speed)[0]
