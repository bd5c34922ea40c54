"""The complete plant: all forces and torques on the machine."""

from dataclasses import dataclass

import numpy as np

from simgap.plants.airframe import Airframe
from simgap.plants.case import PlantCase
from simgap.plants.outside import Disturbance, Moment, disturbances
from simgap.plants.payload import Payload
from simgap.plants.rotation import Array
from simgap.plants.spin import Spin
from simgap.plants.wind import wind_along
from simgap.platforms import Quadrotor


@dataclass
class Plant:
    """The machines of all runs in their air.

    Attributes:
        airframe: rigid body and rotors.
        inflow: the rotors' last induced velocities, m/s.
        spin: the rotors' angular momentum; None where it is left out.
        wind: (steps, runs, 3) world frame, m/s; None for still air.
        payload: the loads; None where nothing hangs.
        disturbances: what the catalogue has no name for.
    """

    airframe: Airframe
    inflow: Array
    spin: Spin | None
    wind: Array | None
    payload: Payload | None
    disturbances: list[Disturbance]

    def push(
        self, index: int, state: Array, rotation: Array, speed: Array, acceleration: Array
    ) -> tuple[Array, Array]:
        """Return specific force (runs, 3), m/s², and torque (runs, 3), N·m, body frame, at a step.

        Args:
            index: of the step.
            state: position, velocity, attitude and body rate (runs, 13).
            rotation: body to world (runs, 3, 3).
            speed: of the rotors (runs, 4), rad/s.
            acceleration: of the rotors (runs, 4), rad/s².
        """
        body_rate = state[:, 10:]
        airspeed = state[:, 3:6] if self.wind is None else state[:, 3:6] - self.wind[index]
        velocity = (airspeed[:, None] @ rotation)[:, 0]
        force, torque, self.inflow = self.airframe.wrench(
            velocity, body_rate, speed, self.inflow, height=state[:, 2]
        )
        if self.spin is not None:
            torque = torque + self.spin.torque(speed, acceleration, body_rate)
        now = Moment(index, rotation, velocity, speed)
        for disturbance in self.disturbances:
            force, torque = disturbance(now, force, torque)
        if self.payload is not None:
            mass = self.airframe.mass
            pull = self.payload.pull(mass * (rotation @ force[..., None])[..., 0], airspeed)
            force = force + (pull[:, None] @ rotation)[:, 0] / mass
        return force, torque


def build(
    airframe: Airframe,
    platform: Quadrotor,
    case: PlantCase,
    steps: int,
    step: float,
    random: np.random.Generator,
) -> Plant:
    """Return the plant of a case, at rest in its air.

    Args:
        airframe: from `design`.
        platform: for the hover rotor speed.
        case: what is concealed.
        steps: of the flight.
        step: s.
        random: for gusts and flutter; each draws from a child of its own, so that twins keep their noise.
    """
    for_wind, for_outside = random.spawn(2)
    hover = platform.hover_rotor_speed
    accelerating, tilting = (case.strength(name) for name in ("rotor_inertia_torque", "gyroscopic_torque"))
    load, length = (case.strength("slung_payload", name) for name in ("mass_ratio", "length"))
    return Plant(
        airframe=airframe,
        inflow=airframe.rotor.still_inflow(np.full((case.runs, 4), hover)),
        spin=Spin(airframe.rotor_directions, accelerating, tilting) if accelerating or tilting else None,
        wind=wind_along(case, steps, step, for_wind),
        payload=Payload(airframe.mass, load * airframe.mass, length, case.runs, step) if load else None,
        disturbances=disturbances(case, airframe, hover, steps, step, for_outside),
    )
