"""Closed-loop simulation of a joint at 1 kHz, all runs at once."""

from dataclasses import dataclass

import numpy as np

from simgap.plants.concealment import Concealed
from simgap.plants.delay import Commands
from simgap.plants.joint.axis import axis_of
from simgap.plants.joint.case import JointCase
from simgap.plants.joint.controller import JointController
from simgap.plants.joint.drive import drive_of
from simgap.plants.joint.servo import servo_of
from simgap.plants.rotation import Array
from simgap.platforms import Joint

STEP = 1e-3  # s
SETTLING = 0.5  # s that pass before the recording starts


@dataclass(frozen=True)
class Log:
    """True signals at every step from `-SETTLING` on; (steps, runs) each.

    Attributes:
        position: of the load, rad or m.
        velocity: rad/s or m/s.
        twist: of the coupling between motor and load, rad or m; 0 where they are one body.
        command: V, N·m or N, or rad or m of a servo that is told a position; before any delay.
        effort: of the motor at the joint, N·m or N.
        cold_effort: that a motor at ambient temperature would give, N·m or N.
        current: A, or the commanded effort where there is no motor.
        battery_voltage: V.
        temperature: °C.
    """

    position: Array
    velocity: Array
    twist: Array
    command: Array
    effort: Array
    cold_effort: Array
    current: Array
    battery_voltage: Array
    temperature: Array


def move(
    effects: Concealed,
    outside: Concealed,
    platform: Joint,
    case: JointCase,
    reference: tuple[Array, Array, Array],
    random: np.random.Generator,
) -> Log:
    """Run all references in closed loop and log the truth.

    Velocity Verlet with the drive at either end of the step: second order, and no shift in time between effort and
    motion that would look like a delay.

    Args:
        effects: what the catalogue names.
        outside: what it does not.
        platform: what the controller believes.
        case: how it is run.
        reference: position, velocity and acceleration, (steps, runs).
        random: the state of battery and winding, the noise of the encoder.
    """
    told = platform.controller is not None
    servo = servo_of(effects, platform, case, random) if told else None
    drive = servo.drive if servo else drive_of(effects, platform, case, random)
    axis = axis_of(effects, outside, platform, case, (reference[0][0], reference[1][0]))
    noise = case.sensors.scale * case.sensors.position * random.standard_normal(reference[0].shape)
    commands = Commands(effects.get("command_delay", "delay"), STEP, reference[0].shape)
    every = round(1.0 / (case.rate * STEP)) if case.held else 1
    controller = JointController(platform, case, reference[0][0], reference[1][0], every * STEP)

    def effort(command: Array, velocity: Array, step: float) -> Array:
        if servo is None:
            return drive.effort(command, velocity, step)
        return servo.effort(command, axis.position[-1], velocity, step)

    rows: list[tuple[Array, ...]] = []
    for count, now in enumerate(zip(*reference, strict=True)):
        axis.travel(STEP)
        if count % every == 0:
            seen = axis.position[-1] + noise[count]
            commands.note(count, now[0] if told else controller.command(now, seen))
        else:
            commands.keep(count)
        ending = commands.at(count - case.held)
        axis.push(effort(ending, axis.foreseen[0], STEP), STEP)
        if case.held:
            axis.feel(effort(commands.at(count), axis.velocity[0], 0.0))
        moving = axis.position[-1], axis.velocity[-1], axis.position[0] - axis.position[-1]
        pushed = commands.series[count], axis.effort, drive.cold
        rows.append((*moving, *pushed, drive.current, drive.voltage, drive.winding.temperature))
    return Log(*(np.stack(column) for column in zip(*rows, strict=True)))
