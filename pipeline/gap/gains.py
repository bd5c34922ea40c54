"""Gains of a servo's position loop that nobody gave: a first estimate, and free numbers of every hypothesis.

The platform gives the inertia, so that gains have a scale. The first estimate is a regression of what the recorded
motion needs on what the loop would do about it, beside dry friction, weight and a constant load, at the delay of the
command that leaves least. It becomes the nominal simulator. Every hypothesis then fits the gains again beside its
effects, so that no effect is named for what other gains would explain as well.
"""

from dataclasses import dataclass, replace
from typing import Any

import torch
from torch import Tensor

from simgap.effects import Parameter, ParameterError
from simgap.effects.effect import Values
from simgap.effects.shift import shift_in_time
from simgap.equations.fit import clustered_covariance
from simgap.equations.scoring import independent_clusters
from simgap.gap.settings import Gap
from simgap.physics.weak_form import WindowFunctions, mean_of, mean_rate_of, window_functions
from simgap.platforms import Controller, Joint
from simgap.platforms.joint import GAINS
from simgap.recordings.recording import Recording
from simgap.simulation import FittedEffect, Simulator
from simgap.simulation.blocks import Blocks, cut_blocks

_LONGEST_DELAY = 0.2  # s; later commands follow no servo
_DELAY_STEP = 0.25  # samples; a held command is half a sample late
_LEAST_SHARE = 0.1  # of the effort that the motion needs; a loop that made up less would not lead the axis
_LEAST_DAMPING = 0.05  # damping ratio; bearings and back-EMF alone give more
_SLOW = 0.1  # of the RMS velocity, below which the sign of a velocity is not trusted


class IdentifiedGain(ParameterError):
    """A gain that nobody gave, over its first estimate."""

    name = "identified_gain"
    kind = "joint"
    names_physics = False
    spread = 1.0  # of the logarithm: the first estimate knows the size, and hypotheses share the prior
    parameters = (Parameter("ratio", "1", 1.2, 0.01, 100.0, neutral=1.0),)
    formula = "gain = ratio · first estimate"
    source = "the platform's nominal equations"
    sentence = "The gain is {ratio} times its first estimate."
    excitation = "command steps of several sizes"
    symptom = "The platform file gives no gain."

    def __init__(self, gain: str) -> None:
        """Identify `proportional` or `derivative`."""
        self.gain = gain

    def __eq__(self, other: object) -> bool:
        """Whether both are of the same gain."""
        return isinstance(other, IdentifiedGain) and other.gain == self.gain

    def __hash__(self) -> int:
        return hash(self.gain)

    @property
    def key(self) -> str:
        """The name, unique for each gain."""
        return f"identified_{self.gain}"

    def adjust(self, constants: Values, values: Values) -> dict[str, Any]:
        """Return the constants with the gain scaled."""
        return {**constants, self.gain: values["ratio"] * constants[self.gain]}


@dataclass(frozen=True)
class _Estimate:
    """A regression at one delay.

    Attributes:
        values: coefficients, the unknown gains first.
        std: their standard errors, robust to correlation inside clusters.
        left: mean square of what is left, (N·m)² or N².
    """

    values: Tensor
    std: Tensor
    left: float


def is_told_a_position(recording: Recording) -> bool:
    """Whether a recorded joint was driven by a position command, and nothing is known of its effort."""
    return "position_command" in recording.units and not {"effort", "voltage"} & recording.units.keys()


def with_gains(recording: Recording, nominal: Simulator, settings: Gap) -> Simulator:
    """Return the nominal simulator of a servo with first estimates of the gains that nobody gave, to be fitted.

    Any other simulator is returned as it is.

    Args:
        recording: cleaned, with its runs divided.
        nominal: what is believed before.
        settings: of the gap engine.
    """
    platform = nominal.platform
    if not isinstance(platform, Joint) or not is_told_a_position(recording):
        return nominal
    controller = platform.controller or Controller()
    if controller.unknown:
        blocks = _fitted_blocks(recording, nominal, settings)
        controller = _identified(blocks, replace(platform, controller=controller), nominal, settings)
    free = tuple(
        FittedEffect(IdentifiedGain(gain), {"ratio": 1.0})
        for gain in ("proportional", "derivative")
        if gain not in controller.given
    )
    # What drives the axis is the loop; of a motor inside it nothing is known but what the loop makes of it.
    told = replace(nominal, platform=replace(platform, controller=controller, motor=None))
    return told.with_effects((*nominal.effects, *free))


def folded(simulator: Simulator) -> Simulator:
    """Return a simulator with its identified gains as numbers of the platform, with their standard errors."""
    platform = simulator.platform
    found = [f for f in simulator.effects if isinstance(f.effect, IdentifiedGain)]
    if not found or not isinstance(platform, Joint):
        return simulator
    controller = platform.controller or Controller()
    for fitted in found:
        gain = fitted.effect.gain  # type: ignore[attr-defined]
        first = getattr(controller, gain)
        numbers = {gain: first * fitted.values["ratio"], f"{gain}_std": first * fitted.std.get("ratio", 0.0)}
        controller = replace(controller, **numbers)
    kept = tuple(f for f in simulator.effects if f not in found)
    return replace(simulator, platform=replace(platform, controller=controller), effects=kept)


def gain_remarks(simulator: Simulator, nominal: Simulator) -> list[str]:
    """Return a sentence about each gain that was identified.

    Args:
        simulator: with the gains as they were found, see `folded`.
        nominal: with the first estimates.
    """
    found, first = (
        each.platform.controller if isinstance(each.platform, Joint) else None
        for each in (simulator, nominal)
    )
    if found is None or first is None:
        return []
    identified = [gain for gain in GAINS if gain not in first.given and getattr(found, gain) is not None]
    units = {"proportional": "N·m/rad", "derivative": "N·m·s/rad"}
    if simulator.position_unit == "m":
        units = {"proportional": "N/m", "derivative": "N·s/m"}
    return [
        f"controller.{gain} was not given; it was identified as {_estimated(found, gain)} {units[gain]} "
        f"(first estimate {_estimated(first, gain)}), in the scale of the platform's inertia"
        for gain in identified
    ]


def _estimated(controller: Controller, gain: str) -> str:
    std = getattr(controller, f"{gain}_std")
    return f"{getattr(controller, gain):.4g}" + (f" ± {std:.2g}" if std else "")


def _fitted_blocks(recording: Recording, nominal: Simulator, settings: Gap) -> Blocks:
    blocks = cut_blocks(recording, nominal.platform, settings.block_duration, settings.margin, held=False)
    kept = [run for run in blocks.runs if recording.split.get(run, "train") != "holdout"]
    return blocks.of_runs(kept).thinned(settings.most_blocks)


def _identified(blocks: Blocks, platform: Joint, nominal: Simulator, settings: Gap) -> Controller:
    """Return the controller with a first estimate of each gain that is unknown."""
    controller = platform.controller
    assert controller is not None
    functions = window_functions(blocks.samples, settings.test_width, blocks.time_step)
    most = min(round(_LONGEST_DELAY / blocks.time_step), blocks.margin)
    needed = _needed(blocks, functions, platform)
    delays = torch.arange(0.0, most + 0.1, _DELAY_STEP).tolist()
    tried = [_regressed(blocks, functions, platform, nominal, needed, late) for late in delays]
    best = min(tried, key=lambda estimate: estimate.left)
    pairs = zip(best.values.tolist(), best.std.tolist(), strict=True)
    found = dict(zip(controller.unknown, pairs, strict=False))
    return _bounded(controller, found, blocks, platform, float(needed.square().mean().sqrt()))


def _bounded(
    controller: Controller,
    found: dict[str, tuple[float, float]],
    blocks: Blocks,
    platform: Joint,
    needed: float,
) -> Controller:
    """Return the controller with gains that are at least what leads an axis at all."""
    if "proportional" in found:
        value, std = found["proportional"]
        error = blocks.inner(blocks.signals["position_command"] - blocks.signals["position"])
        least = _LEAST_SHARE * needed / max(float(error.square().mean().sqrt()), 1e-12)
        controller = replace(controller, proportional=max(value, least, 1e-12), proportional_std=std)
    if "derivative" in found:
        value, std = found["derivative"]
        assert controller.proportional is not None
        least = 2.0 * _LEAST_DAMPING * (controller.proportional * platform.inertia) ** 0.5
        controller = replace(controller, derivative=max(value, least), derivative_std=std)
    return controller


def _needed(blocks: Blocks, functions: WindowFunctions, platform: Joint) -> Tensor:
    """Return the effort that the recorded motion needs by the platform's equations, (blocks, rows)."""
    position = blocks.inner(blocks.signals["position"])
    rate = mean_rate_of(functions, platform.inertia * blocks.inner(blocks.signals["velocity"]))
    load = platform.gravity_torque * torch.sin(position) + platform.stiffness * position
    return rate + mean_of(functions, load)


def _regressed(
    blocks: Blocks,
    functions: WindowFunctions,
    platform: Joint,
    nominal: Simulator,
    needed: Tensor,
    late: float,
) -> _Estimate:
    """Regress the effort that is needed on what the loop and the usual loads do, with the command so late."""
    controller = platform.controller
    assert controller is not None
    told = shift_in_time(blocks.signals["position_command"], late * blocks.time_step, blocks.time_step)
    position, velocity = blocks.signals["position"], blocks.signals["velocity"]
    slow = _SLOW * float(velocity.square().mean().sqrt()) or 1.0
    loop = {"proportional": told - position, "derivative": -velocity}
    loads = [-torch.tanh(velocity / slow), torch.ones_like(position), position]
    if nominal.position_unit == "rad":
        loads += [torch.sin(position), torch.cos(position)]
    columns = [loop[gain] for gain in controller.unknown] + loads
    rows = torch.stack([mean_of(functions, blocks.inner(column)) for column in columns], -1)
    known = sum(
        (
            getattr(controller, gain) * mean_of(functions, blocks.inner(loop[gain]))
            for gain in controller.given
        ),
        torch.zeros_like(needed),
    )
    target = (needed - known)[..., None]
    solution = torch.linalg.lstsq(rows.flatten(0, 1), target.flatten(0, 1), driver="gelsd").solution[:, 0]
    residual = target - (rows @ solution)[..., None]
    scale = residual.square().mean().sqrt().clamp_min(1e-12).expand(1, 1, 1)
    covariance = clustered_covariance(rows[:, :, None], residual, scale, independent_clusters(blocks))
    return _Estimate(solution, covariance.diagonal().clamp_min(0.0).sqrt(), float(residual.square().mean()))
