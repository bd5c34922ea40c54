"""Electrical time constant of a motor, for joints and swerve drives.

The torque of a sample is the mean over the interval for which the sample's voltage stands.
"""

from typing import Any, ClassVar

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values
from simgap.effects.lag import lag_along_time, lag_step
from simgap.physics.shapes import Signal


class MotorInductance(ActuatorEffect):
    """The motor current follows the voltage with a time constant of inductance over resistance."""

    group: ClassVar[str] = ""
    """Prefix of the names of constants: `drive_` or `steer_` for a swerve drive."""
    delayed: ClassVar[str]
    """The signal that follows the current: effort or torque."""

    remembers = True
    smooths_commands = True
    order = 1
    name = "motor_inductance"
    parameters = (Parameter("inductance", "H", 5e-3, 0.0, 10.0),)
    formula = "inductance · d(current)/dt = voltage − K·velocity − resistance · current"
    source = "Krishnan 2001, Electric motor drives, §2"
    excitation = "step and reverse the voltage quickly, and sample faster than the current rises"
    symptom = "After a voltage step the torque rises gradually instead of at once."

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan over the usual windings."""
        return [{"inductance": 1e-5 * 10.0**step} for step in range(5)]

    def lateness(self, values: Values, constants: Values) -> float:
        """Return the winding's time constant."""
        return float(self._time_constant(values, constants))

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the mean torque of the step; the memory holds the torque at its end."""
        target = signals[self.delayed]
        start = target if memory is None else memory
        mean, end = lag_step(start, target, self._time_constant(values, constants), time_step)
        return {self.delayed: mean}, end

    def along_time(
        self, signals: Signals, values: Values, constants: Values, time_step: float
    ) -> dict[str, Signal]:
        """Filter whole blocks at once: the same as sample by sample."""
        time_constant = self._time_constant(values, constants)
        return {**signals, self.delayed: lag_along_time(signals[self.delayed], time_constant, time_step)}

    def _time_constant(self, values: Values, constants: Values) -> Any:
        return values["inductance"] / constants[f"{self.group}resistance"]
