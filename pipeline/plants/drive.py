"""Drive of a quadrotor: transport delay, supply voltage and motor lag."""

import math
from collections import deque

import numpy as np

from simgap.plants.battery import Battery
from simgap.plants.case import PlantCase
from simgap.plants.rotation import Array
from simgap.platforms import Quadrotor

_LAG_SPREAD = 0.1  # standard deviation of the rotors' time constants over the mean of the four
_SCALE_SPREAD = (
    0.003  # standard deviation of the rotors' speed per command over the mean: motors of one batch
)
_TURNOVER = 0.02  # of the command, over which a speed controller goes from driving to letting go
_RESISTIVE_SHARE = 0.3  # of a motor's voltage over its back-EMF at hover
_ELASTICITY = (1.0 + _RESISTIVE_SHARE) / (1.0 + 2.0 * _RESISTIVE_SHARE)


class Drive:
    """Four motors in each run; call it once a step."""

    def __init__(
        self,
        platform: Quadrotor,
        case: PlantCase,
        random: np.random.Generator,
        step: float,
        battery: Battery,
    ) -> None:
        """Draw the rotors' time constants.

        Args:
            platform: nominal voltage and hover rotor speed are taken from it.
            case: lag, delay and sensitivity to voltage are taken from it.
            random: for the spread of the rotors.
            step: s.
            battery: drained only where the motors feel its voltage.
        """
        self.step, self.battery, self.platform = step, battery, platform
        self.scale = _scales(case, random)
        self.decay = _lag_decay(case, random, step)
        self.down_ratio = case.strength("motor_lag", "down_ratio")
        self.delay = case.strength("command_delay") / step
        self.commands: deque[Array] = deque(maxlen=math.floor(self.delay) + 2)
        self.exponent = sag_exponent(case.strength("battery_sag"))
        self.speed: Array | None = None
        self.voltage: Array | None = None

    def __call__(self, command: Array) -> tuple[Array, Array]:
        """Return rotor speed (runs, 4), rad/s, and its rate of change, rad/s², for a command in rad/s."""
        before = np.full_like(command, self.platform.hover_rotor_speed) if self.speed is None else self.speed
        wanted = self.scale * self._delayed(command)
        if self.exponent > 0:
            self.voltage = self.battery(before, self.step)
            ratio = (self.voltage / self.platform.nominal_voltage) ** self.exponent
            wanted = speed_at_voltage(wanted, ratio[:, None], self.platform.hover_rotor_speed)
        self.speed = wanted + (before - wanted) * self._decay(before, wanted)
        return self.speed, (self.speed - before) / self.step

    def _decay(self, speed: Array, wanted: Array) -> Array:
        """Return the share of the distance to the wanted speed that is kept over a step.

        With time constants apart by `down_ratio`, their geometric mean stays, and the change from one to the other is
        gradual.
        """
        if self.down_ratio == 1.0:
            return self.decay
        slowing = np.tanh((speed - wanted) / (_TURNOVER * wanted))
        return self.decay ** (self.down_ratio ** (-0.5 * slowing))

    def _delayed(self, command: Array) -> Array:
        """Return the command of `delay` steps ago, between steps linear; at first the first."""
        if self.delay == 0:
            return command
        self.commands.append(command)
        place = max(len(self.commands) - 1 - self.delay, 0.0)
        below = math.floor(place)
        share = place - below
        later = self.commands[min(below + 1, len(self.commands) - 1)]
        return (1.0 - share) * self.commands[below] + share * later


def sag_exponent(sensitivity: float) -> float:
    """Return the power of the relative voltage that reaches a motor whose hover speed has a given sensitivity.

    A controller that compensates nothing passes all of it, which gives `_ELASTICITY`.
    """
    return sensitivity / _ELASTICITY


def speed_at_voltage(command: Array, ratio: Array, hover: float) -> Array:
    """Return the speed of a motor without speed loop.

    The duty that gives the commanded speed at nominal voltage, k·Ω + (R·c/k)·Ω² = duty·V with back-EMF k·Ω and
    the current of a propeller's torque c·Ω², gives at another voltage the root of the same equation.

    Args:
        command: speed at nominal voltage (..., 4), rad/s.
        ratio: voltage over nominal, as much of it as the speed controller lets through, (..., 1).
        hover: rotor speed at which the resistive drop is `_RESISTIVE_SHARE` of the back-EMF, rad/s.
    """
    bend = _RESISTIVE_SHARE / hover
    supplied = ratio * command * (1.0 + bend * command)
    return 2.0 * supplied / (1.0 + np.sqrt(1.0 + 4.0 * bend * supplied))


def _scales(case: PlantCase, random: np.random.Generator) -> Array | float:
    """Return each rotor's speed over its command, (4,), with the mean that is concealed; 1 where none is."""
    mean = case.strength("command_scale_error")
    if mean == 1.0:
        return 1.0
    spread = 1.0 + _SCALE_SPREAD * np.clip(random.spawn(1)[0].standard_normal(4), -2.0, 2.0)
    return mean * spread / spread.mean()


def _lag_decay(case: PlantCase, random: np.random.Generator, step: float) -> Array:
    """Share of the distance to the command that each rotor keeps over a step, (4,)."""
    spread = 1.0 + _LAG_SPREAD * np.clip(random.standard_normal(4), -2.0, 2.0)
    mean = case.strength("motor_lag")
    return np.exp(-step / (mean * spread / spread.mean())) if mean > 0 else np.zeros(4)
