"""Drive of a joint: scale, dead zone, response, supply, winding, inductance and current limit."""

from dataclasses import dataclass

import numpy as np

from simgap.plants.concealment import Concealed
from simgap.plants.joint.case import JointCase
from simgap.plants.joint.supply import AMBIENT, COPPER_SHARE, Battery, Winding, battery_of, winding_of
from simgap.plants.rotation import Array
from simgap.platforms import Joint

_FAST_SHARE = 0.15  # of the drive's response time that a second, faster stage takes up


@dataclass
class Drive:
    """The drive of one axis.

    Attributes:
        resistance: at ambient temperature, Ω; 0 where an effort is commanded.
        constant: effort per current, N·m/A, and back-EMF per velocity, V·s/rad; 1 where an effort is commanded.
        supply: nominal voltage, V.
        sagging: whether the battery's voltage reaches the motor.
        weakening: by warmth, at standstill, 1/K.
        scale: by which the command that acts is greater than the one that is given.
        dead_zone: half width, in the unit of the command.
        response: times of the two stages through which the output follows the command, s.
        electrical: time constant of the winding, s.
        limit: of the current, A.
        battery: its state.
        winding: its state.
        current: (runs,) A.
        voltage: of the battery, (runs,) V.
        cold: effort that the motor would give at ambient temperature, (runs,) N·m or N.
        stages: state of the two stages, in the unit of the command; None before the first step.
    """

    resistance: float
    constant: float
    supply: float
    sagging: bool
    weakening: float
    scale: float
    dead_zone: float
    response: tuple[float, float]
    electrical: float
    limit: float
    battery: Battery
    winding: Winding
    current: Array
    voltage: Array
    cold: Array
    stages: tuple[Array, Array] | None = None

    def effort(self, command: Array, velocity: Array, step: float) -> Array:
        """Return the motor's effort at the joint (runs,), N·m or N.

        Args:
            command: delayed, V or N·m or N.
            velocity: of the motor in the joint's terms, rad/s or m/s.
            step: since the last call, s; 0 to look without letting time pass.
        """
        command = self._followed(self._passed(command), step)
        lost = self.weakening * (self.winding.temperature - AMBIENT)
        if not self.resistance:
            self.current = self.cold = command
            self.winding.warm(command, step)
            return (1.0 - lost) * command
        drawn = np.abs(command / self.supply * self.current)
        self.voltage = self.battery.voltage(drawn, step)
        applied = command * (self.voltage / self.supply) if self.sagging else command
        resistance = self.resistance * (1.0 + COPPER_SHARE * lost)
        self.cold = self.constant * (applied - self.constant * velocity) / self.resistance
        constant = self.constant * (1.0 - (1.0 - COPPER_SHARE) * lost)
        settled = (applied - constant * velocity) / resistance
        if self.electrical:
            settled = settled + (self.current - settled) * np.exp(-step / self.electrical)
        self.current = np.clip(settled, -self.limit, self.limit)
        self.winding.warm(self.current, step)
        return constant * self.current

    def _passed(self, command: Array) -> Array:
        """Return what of a command (runs,) the drive takes up."""
        command = self.scale * command
        return command - np.clip(command, -self.dead_zone, self.dead_zone) if self.dead_zone else command

    def _followed(self, command: Array, step: float) -> Array:
        """Return the output (runs,) after a step, through two first-order stages; a real drive has more than one."""
        if not self.response[0]:
            return command
        output, stages = command, []
        for before, time in zip(self.stages or (command, command), self.response, strict=True):
            output = output + (before - output) * np.exp(-step / time)
            stages.append(output)
        self.stages = stages[0], stages[1]
        return output


def drive_of(effects: Concealed, platform: Joint, case: JointCase, random: np.random.Generator) -> Drive:
    """Return the drive that a case conceals, before its first step."""
    motor = None if platform.controller is not None else platform.motor
    size = case.size(platform)
    ratio = effects.get("motor_constant_error", "ratio")
    response = effects.get("motor_lag", "time_constant")
    still = np.zeros(case.runs)
    return Drive(
        resistance=motor.resistance if motor else 0.0,
        constant=motor.torque_constant * motor.gear_ratio * ratio if motor else 1.0,
        supply=case.supply,
        sagging="battery_sag" in effects,
        weakening=effects.get("temperature_derating", "coefficient"),
        scale=effects.get("input_scale_error", "ratio"),
        dead_zone=effects.get("dead_zone", "width"),
        response=((1.0 - _FAST_SHARE) * response, _FAST_SHARE * response),
        electrical=effects.get("motor_inductance", "time_constant"),
        limit=effects.get("current_limit", "limit"),
        battery=battery_of(effects, case.supply, size["current"], case.runs, random),
        winding=winding_of(size["current"], case.runs, random),
        current=still,
        voltage=np.full(case.runs, case.supply),
        cold=still,
    )
