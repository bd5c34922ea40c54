"""The rig in closed loop, a thousand steps a second, all runs at once."""

import numpy as np

from pipeline.platforms import Quadrotor
from pipeline.reality.airframe import Airframe
from pipeline.reality.battery import Battery
from pipeline.reality.controller import Controller, tuned
from pipeline.reality.delay import Commands
from pipeline.reality.drive import Drive
from pipeline.reality.flight import SETTLING, STEP, Gyro, Log, log_of
from pipeline.reality.integration import AdamsBashforth
from pipeline.reality.plant import build
from pipeline.reality.rig.bearings import Bearings, inertia_with
from pipeline.reality.rig.case import RigCase
from pipeline.reality.rig.sticks import Sticks
from pipeline.reality.rotation import Array, cross, matrix, product

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
    sticks = Sticks(case, (count - 1) // hold + 1, random[0])
    commands = Commands(case.latency, STEP, (count, case.runs, 3), held=True)
    plant = build(airframe, platform, case.plant, count, STEP, random[1])
    drive, gyro = Drive(platform, case.plant, random[1], STEP, battery), Gyro(case.plant, random[1], STEP)
    autopilot = Autopilot(case, platform)
    bearings = Bearings(case.gimbal, airframe.mass * airframe.gravity, case.runs, STEP)
    inertia, advance = inertia_with(case.gimbal, airframe.inertia), AdamsBashforth(STEP)
    state = np.zeros((case.runs, 13))
    state[:, 2], state[:, 6] = _HEIGHT, 1.0
    kept = []
    for index in range(count):
        rotation, body_rate = matrix(state[:, 6:10]), state[:, 10:]
        if index % hold:
            commands.keep(index)
        else:
            commands.note(index, sticks(index // hold, rotation))
        asked = autopilot(commands.at(index), gyro(body_rate))
        speed, acceleration = drive(asked)
        _, torque = plant.push(index, state, rotation, speed, acceleration)
        felt = [] if drive.voltage is None else [drive.voltage]
        kept.append((state, airframe.gravity * rotation[:, 2, :], speed, asked, *felt))
        state = advance(state, derivative(state, torque + bearings(rotation, body_rate), inertia))
        state[:, 6:10] /= np.linalg.norm(state[:, 6:10], axis=-1, keepdims=True)
    return log_of(kept, STEP), commands.series


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
