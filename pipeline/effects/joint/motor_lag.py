"""Response time of the drive of a joint.

A drive follows its command with a first-order lag: an inner current or speed loop, an amplifier, a filter of the
command. It lags the voltage or the effort, whichever is commanded. The back-EMF is not lagged: it follows the speed at
once. That, and its size, tells a slow drive from the inductance of a winding.
"""

from typing import Any

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values
from simgap.effects.joint.common import commanded, driven_by
from simgap.effects.lag import lag_along_time, lag_step
from simgap.physics.shapes import Signal


class MotorLag(ActuatorEffect):
    """The drive follows its command with a first-order lag."""

    remembers = True
    smooths_commands = True
    order = 0
    name = "motor_lag"
    kind = "joint"
    acts_on = "actuator"
    parameters = (Parameter("time_constant", "s", 0.03, 0.0, 0.5),)
    needs = ("effort",)
    formula = (
        "d(output)/dt = (command − output) / time_constant, with the voltage or the effort as the command"
    )
    source = "Franklin, Powell & Emami-Naeini 2019, Feedback control of dynamic systems, §3.3: first-order response"
    sentence = (
        "The drive follows its command with a time constant of {time_constant} s; add a first-order lag to the "
        "simulator."
    )
    excitation = "step the command, or run a fast chirp, which separates a slow rise from a late start"
    symptom = "After a command step the effort rises exponentially instead of at once."
    look_alikes = ("command_delay", "motor_inductance", "sensor_time_offset")

    def starts(self) -> list[dict[str, float]]:
        """Start from none, and from a scan over the decades: a periodic command has several local minima."""
        return [{"time_constant": constant} for constant in (0.0, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2)]

    def lateness(self, values: Values, constants: Values) -> float:
        """Return the time constant."""
        return float(values["time_constant"])

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the mean output over the step; the memory holds the output at its end."""
        target = signals[commanded(signals)]
        start = target if memory is None else memory
        mean, end = lag_step(start, target, values["time_constant"], time_step)
        return driven_by(mean, signals, constants), end

    def along_time(
        self, signals: Signals, values: Values, constants: Values, time_step: float
    ) -> dict[str, Signal]:
        """Lag whole blocks at once: the same as sample by sample."""
        lagged = lag_along_time(signals[commanded(signals)], values["time_constant"], time_step)
        return {**signals, **driven_by(lagged, signals, constants)}
