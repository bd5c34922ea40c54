"""Pure time delay between a command and its effect, for every kind of platform."""

import math
from typing import Any, ClassVar

import torch

from simgap.effects.effect import CommandEffect, Parameter, Signals, Values
from simgap.effects.shift import shift_in_time
from simgap.physics.shapes import Signal


class CommandDelay(CommandEffect):
    """Commands take effect a fixed time after they are recorded."""

    delayed: ClassVar[tuple[str, ...]]
    """The signals to delay, if present."""

    remembers = True
    name = "command_delay"
    acts_on = "command"
    parameters = (Parameter("delay", "s", 0.02, 0.0, 0.3),)
    formula = "command_effective(t) = command(t − delay)"
    source = "Hwangbo et al. 2019, Learning agile and dynamic motor skills, actuator latency"
    sentence = "Commands take effect {delay} s after they are recorded; delay them in the simulator."
    excitation = "command steps or a fast chirp, which separate a late start from a slow rise"
    symptom = "The response to a command step starts late and then rises at the normal rate."

    def starts(self) -> list[dict[str, float]]:
        """Start from none, and from a scan: a periodic command has a local minimum at each period."""
        return [{"delay": delay} for delay in (0.0, 0.01, 0.02, 0.04, 0.08, 0.16)]

    def lateness(self, values: Values, constants: Values) -> float:
        """Return the delay."""
        return float(values["delay"])

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the commands of `delay` ago; the memory holds what was commanded since."""
        present = [name for name in self.delayed if name in signals]
        if not present:
            return {}, None
        delay = torch.as_tensor(values["delay"], dtype=signals[present[0]].dtype) / time_step
        whole = math.floor(delay)
        history = memory or {name: [signals[name]] * (whole + 2) for name in present}
        history = {name: [signals[name], *history[name][: whole + 1]] for name in present}
        fraction = delay - whole
        out = {
            name: (1.0 - fraction) * history[name][whole] + fraction * history[name][whole + 1]
            for name in present
        }
        return out, history

    def along_time(
        self, signals: Signals, values: Values, constants: Values, time_step: float
    ) -> dict[str, Signal]:
        """Shift whole blocks at once: the same as sample by sample, in one step."""
        shifted = {
            name: shift_in_time(signals[name], values["delay"], time_step)
            for name in self.delayed
            if name in signals
        }
        return {**signals, **shifted}
