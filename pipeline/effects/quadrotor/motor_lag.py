"""Response time of the motors of a quadrotor."""

from typing import Any

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values
from simgap.effects.lag import lag_along_time, lag_step, uneven_lag_along_time, uneven_lag_step
from simgap.physics.shapes import Signal


class MotorLag(ActuatorEffect):
    """Rotor speed follows its command with a first-order lag, perhaps another one down than up."""

    remembers = True
    smooths_commands = True
    order = 2
    name = "motor_lag"
    kind = "quadrotor"
    acts_on = "actuator"
    prior_odds = 1.0  # every rotor has inertia
    # The geometric mean of both times and their ratio: an estimate of the one hardly depends on the other.
    # A rotor is slower than its controller: 12.5 ms up and 25 ms down (Furrer et al.), 33 ms (Kaufmann et al.), 70 ms
    # (Eschmann, Albani & Loianno 2024, Data-driven system identification of quadrotors subject to motor delays).
    parameters = (
        Parameter("time_constant", "s", 0.04, 0.0, 0.5, typical=True),
        Parameter("down_ratio", "1", 1.4, 0.2, 5.0, neutral=1.0, optional=True),
    )
    needs = ("motor_command",)
    formula = (
        "dΩ/dt = (Ω_commanded − Ω) / T, T = time_constant / √down_ratio while the rotor speeds up, "
        "time_constant · √down_ratio while it slows down"
    )
    source = (
        "Kaufmann et al. 2023, Champion-level drone racing using deep reinforcement learning, Methods; Furrer et al. "
        "2016, RotorS, a modular Gazebo MAV simulator framework, for one time constant up and another one down"
    )
    sentence = (
        "The rotors follow their command with a time constant of {time_constant} s, and take {down_ratio} times as "
        "long to slow down as to speed up; add a first-order lag to the simulator."
    )
    excitation = "step the throttle up and down by the same amount, then step or chirp roll and pitch"
    symptom = "After a command step the rotor speed rises or falls exponentially instead of at once."
    look_alikes = ("sensor_time_offset",)

    def starts(self) -> list[dict[str, float]]:
        """Start from none, and from a scan: a periodic command has several local minima."""
        return [
            {"time_constant": time_constant, "down_ratio": 1.0}
            for time_constant in (0.0, 0.01, 0.03, 0.08, 0.2)
        ]

    def lateness(self, values: Values, constants: Values) -> float:
        """Return the time constant."""
        return float(values["time_constant"])

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the mean rotor speed over the step; the memory holds the speed at its end."""
        target = signals["rotor_speed"]
        start = target if memory is None else memory
        if _is_even(values):
            mean, end = lag_step(start, target, values["time_constant"], time_step)
        else:
            mean, end = uneven_lag_step(start, target, *_times(values), time_step)
        return {"rotor_speed": mean}, end

    def along_time(
        self, signals: Signals, values: Values, constants: Values, time_step: float
    ) -> dict[str, Signal]:
        """Lag whole blocks at once: the same as sample by sample."""
        target = signals["rotor_speed"]
        if _is_even(values):
            lagged = lag_along_time(target, values["time_constant"], time_step)
        else:
            lagged = uneven_lag_along_time(target, *_times(values), time_step)
        return {**signals, "rotor_speed": lagged}


def _is_even(values: Values) -> bool:
    """Whether both times are one: only a number says so, for a tensor may ask for its gradient."""
    ratio = values.get("down_ratio", 1.0)
    return isinstance(ratio, int | float) and ratio == 1.0


def _times(values: Values) -> tuple[Any, Any]:
    """Return the time constants up and down, s."""
    root = values["down_ratio"] ** 0.5
    return values["time_constant"] / root, values["time_constant"] * root
