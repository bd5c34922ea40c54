"""Typical sizes of a recording's signals, in which the priors of parameters are measured.

A prior of an absolute width would decide by the unit that a machine is described in. What is a plausible friction follows
from how hard the machine was driven, a plausible stiffness from effort and travel.
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass

import torch
from torch import Tensor

from simgap.effects import Effect, Parameter, effects_of
from simgap.simulation import Simulator
from simgap.simulation.blocks import Blocks

_SHARE_OF_SIGNAL = 0.3
"""A law that is worth naming changes what drives the machine by some tenths; this is a width, not a bound."""
_REACTION = 0.02
"""Of delays and lags, s: what buses, filters and motor controllers take, however slow the machine."""
_REST_SPREADS, _REST_SHARE = 3.0, 0.1
"""A driver rests within some of its own changes of where it was recorded, or a tenth of its usual size."""
_FACTOR = re.compile(r"(?P<unit>[A-Za-z]+(?:·m)?)(?P<power>[²³])?$")
_POWERS = {None: 1, "²": 2, "³": 3}


@dataclass(frozen=True)
class Scales:
    """Root mean squares of an axis' signals over a recording, by the unit that they carry.

    Attributes:
        sizes: by unit: `N·m` (or `N`) of the effort, `rad` (or `m`) of the position about its mean, `V`, `A` and so on.
        drivers: mean and spread of the slow signals, by name.
    """

    sizes: Mapping[str, float]
    drivers: Mapping[str, tuple[float, float]]

    def driver(self, effect: Effect, parameter: Parameter) -> tuple[float, float]:
        """Return where the driver of an effect rests, and how far that may be off: it was recorded at work."""
        mean, spread = self.drivers.get(effect.driver, (parameter.default, 0.0))
        return mean, _REST_SPREADS * spread + _REST_SHARE * abs(parameter.default)

    def of(self, unit: str) -> float | None:
        """Return the size that a parameter of this unit has where its law is worth a share of the signals.

        `N·m·s/rad` is effort over velocity: the recording's effort, travel and duration scales are multiplied as the
        unit says. None where a factor of the unit has no size here.
        """
        if unit == "s":
            return _REACTION
        above, _, below = unit.partition("/")
        if above == "1" and below:
            return None
        size = _SHARE_OF_SIGNAL
        for part, sign in ((above, 1), (below, -1)):
            for factor in filter(None, re.split(r"·(?!m\b)", part)):
                known = _size_of_factor(factor, self.sizes)
                if known is None:
                    return None
                size *= known**sign
        return size


def scales_of(simulator: Simulator, blocks: Blocks) -> Scales:
    """Return the sizes of what a recording of one axis holds; no sizes for machines of other kinds."""
    signals = simulator.along_time(blocks.signals, blocks.time_step)
    drivers = {
        name: (float(signals[name].mean()), float(signals[name].std()))
        for name in {effect.driver for effect in effects_of(simulator.platform.kind)} & set(signals)
    }
    if simulator.platform.kind != "joint":
        return Scales({}, drivers)
    position = signals["position"]
    travel, speed = _rms(position - position.mean()), _rms(signals["velocity"])
    sizes = {"1": 1.0, "s": travel / speed}
    sizes |= dict.fromkeys(("N·m", "N"), _rms(signals["effort"])) | dict.fromkeys(("rad", "m"), travel)
    if "voltage" in signals:
        constants = simulator.constants()
        sizes["V"] = _rms(signals["voltage"])
        sizes["A"] = _rms(signals["effort"]) / (constants["torque_constant"] * constants["gear_ratio"])
    return Scales(sizes, drivers)


def _size_of_factor(factor: str, sizes: Mapping[str, float]) -> float | None:
    match = _FACTOR.match(factor)
    if factor == "1":
        return 1.0
    if match is None or match["unit"] not in sizes:
        return None
    return sizes[match["unit"]] ** _POWERS[match["power"]]


def _rms(series: Tensor) -> float:
    return float(torch.sqrt(series.square().mean()).clamp_min(1e-12))
