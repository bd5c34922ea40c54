"""Response time of the motors of a quadrotor."""

from typing import Any

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values
from simgap.effects.lag import lag_along_time, lag_step
from simgap.physics.shapes import Signal


class MotorLag(ActuatorEffect):
    """Rotor speed follows its command with a first-order lag."""

    remembers = True
    smooths_commands = True
    order = 2
    name = "motor_lag"
    kind = "quadrotor"
    acts_on = "actuator"
    parameters = (Parameter("time_constant", "s", 0.04, 0.0, 0.5),)
    needs = ("motor_command",)
    formula = "dΩ/dt = (Ω_commanded − Ω) / time_constant"
    source = "Kaufmann et al. 2023, Champion-level drone racing using deep reinforcement learning, Methods"
    sentence = (
        "The rotors follow their command with a time constant of {time_constant} s; add a first-order lag to "
        "the simulator."
    )
    excitation = "step or chirp the throttle, roll and pitch"
    symptom = "After a command step the rotor speed rises exponentially instead of at once."
    look_alikes = ("sensor_time_offset",)

    def starts(self) -> list[dict[str, float]]:
        """Start from none, and from a scan: a periodic command has several local minima."""
        return [{"time_constant": time_constant} for time_constant in (0.0, 0.01, 0.03, 0.08, 0.2)]

    def lateness(self, values: Values, constants: Values) -> float:
        """Return the time constant."""
        return float(values["time_constant"])

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the mean rotor speed over the step; the memory holds the speed at its end."""
        target = signals["rotor_speed"]
        start = target if memory is None else memory
        mean, end = lag_step(start, target, values["time_constant"], time_step)
        return {"rotor_speed": mean}, end

    def along_time(
        self, signals: Signals, values: Values, constants: Values, time_step: float
    ) -> dict[str, Signal]:
        """Lag whole blocks at once: the same as sample by sample."""
        lagged = lag_along_time(signals["rotor_speed"], values["time_constant"], time_step)
        return {**signals, "rotor_speed": lagged}
