"""Closed-loop simulation of the rig at 1 kHz, all runs at once."""

import numpy as np

from simgap.plants.airframe import Airframe
from simgap.plants.battery import Battery
from simgap.plants.controller import Controller, tuned
from simgap.plants.delay import Commands
from simgap.plants.drive import Drive
from simgap.plants.flight import SETTLING, STEP, Gyro, Log, log_of
from simgap.plants.integration import AdamsBashforth
from simgap.plants.plant import build
from simgap.plants.rig.bearings import Bearings, inertia_with
from simgap.plants.rig.case import RigCase
from simgap.plants.rig.sticks import Sticks
from simgap.plants.rotation import Array, cross, matrix, product
from simgap.platforms import Quadrotor

_HEIGHT = 1.0  # m, at which the rig stands


def turn(
    case: RigCase,
    airframe: Airframe,
    platform: Quadrotor,
    battery: Battery,
    random: list[np.random.Generator],
) -> tuple[Log, Array]:
    """Turn all runs in closed loop.

    Args:
        case: what is concealed.
        airframe: the quadrotor of the case.
        platform: what the autopilot believes.
        battery: of all runs.
        random: for the pilot, and for the plant with its gyro.

    Returns:
        The truth, and the pilot's commands (steps, runs, 3), rad/s.
    """
    count = round((SETTLING + case.duration) / STEP) + 1
    hold = round(1.0 / (case.rate * STEP))
    rig = Rig(case, airframe, platform, battery, count, random[1])
    sticks = Sticks(case, (count - 1) // hold + 1, random[0])
    commands = Commands(case.latency, STEP, (count, case.runs, 3))
    kept = []
    for index in range(count):
        if index % hold:
            commands.keep(index)
        else:
            commands.note(index, sticks(index // hold, matrix(rig.state[:, 6:10])))
        kept.append(rig(index, commands.at(index)))
    return log_of(kept, STEP), commands.series


class Rig:
    """The machines of all runs in their gimbals; call it once a step.

    Attributes:
        state: position, velocity, attitude and body rate (runs, 13); place and velocity stay.
    """

    def __init__(
        self,
        case: RigCase,
        airframe: Airframe,
        platform: Quadrotor,
        battery: Battery,
        steps: int,
        random: np.random.Generator,
    ) -> None:
        """Hold the machines level and at rest; see `turn`."""
        self.gravity = airframe.gravity
        self.plant = build(airframe, platform, case.plant, steps, STEP, random)
        self.drive = Drive(platform, case.plant, random, STEP, battery)
        self.gyro, self.autopilot = Gyro(case.plant, random, STEP), Autopilot(case, platform)
        self.bearings = Bearings(case.gimbal, airframe.mass * airframe.gravity, case.runs, STEP)
        self.inertia, self.advance = inertia_with(case.gimbal, airframe.inertia), AdamsBashforth(STEP)
        self.state = np.zeros((case.runs, 13))
        self.state[:, 2], self.state[:, 6] = _HEIGHT, 1.0

    def __call__(self, index: int, command: Array) -> tuple[Array, ...]:
        """Advance by a step with commanded rates (runs, 3), rad/s; return what `log_of` keeps of its beginning."""
        state, rotation = self.state, matrix(self.state[:, 6:10])
        asked = self.autopilot(command, self.gyro(state[:, 10:]))
        speed, acceleration = self.drive(asked)
        _, torque = self.plant.push(index, state, rotation, speed, acceleration)
        torque = torque + self.bearings(rotation, state[:, 10:])
        self.state = self.advance(state, derivative(state, torque, self.inertia))
        self.state[:, 6:10] /= np.linalg.norm(self.state[:, 6:10], axis=-1, keepdims=True)
        felt = () if self.drive.voltage is None else (self.drive.voltage,)
        return state, self.gravity * rotation[:, 2, :], speed, asked, *felt


class Autopilot:
    """From commanded body rates to rotor speeds, with hover thrust; call it once a step."""

    def __init__(self, case: RigCase, platform: Quadrotor) -> None:
        """Tune it for the machine of the case."""
        self.controller = Controller(platform, tuned(case.plant, platform), STEP)
        self.most = case.quickening * STEP if case.quickening else np.inf
        self.target: Array = np.zeros((case.runs, 3))

    def __call__(self, command: Array, body_rate: Array) -> Array:
        """Return rotor speeds (runs, 4), rad/s, for commanded and measured body rates (runs, 3), rad/s."""
        self.target = self.target + np.clip(command - self.target, -self.most, self.most)
        hover = self.controller.platform.mass * self.controller.platform.gravity
        return self.controller.rotors(np.full(len(command), hover), self.target, body_rate)


def derivative(state: Array, torque: Array, inertia: Array) -> Array:
    """Return the rate of change (runs, 13) of a state whose place is fixed.

    Args:
        state: position, velocity, attitude and body rate (runs, 13).
        torque: about the fixed point, body frame (runs, 3), N·m.
        inertia: about it (3, 3), kg·m².
    """
    body_rate = state[:, 10:]
    change = np.zeros_like(state)
    spin = np.concatenate((np.zeros_like(body_rate[:, :1]), body_rate), axis=-1)
    change[:, 6:10] = 0.5 * product(state[:, 6:10], spin)
    change[:, 10:] = np.linalg.solve(inertia, (torque - cross(body_rate, body_rate @ inertia)).T).T
    return change
