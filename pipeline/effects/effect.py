"""Base classes of effects: one piece of physics, written once for simulator, diagnosis, report and documentation.

An effect acts at one place along command → actuator → wrench → measurement, or it corrects a number of the platform.
Its class says at which place. All functions take tensors with free leading dimensions: a batch of simulated machines,
or blocks of a recording. The simulator and the diagnosis therefore run the same code.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar

import torch
from torch import Tensor

from simgap.effects.parameter import Parameter
from simgap.effects.sizes import sizes_of
from simgap.physics.shapes import Channels, Signal, Signals

Values = Mapping[str, Any]
"""Parameter values (numbers or tensors), or constants of a platform, by name."""


class Effect(ABC):
    """A piece of physics that a nominal simulator may lack.

    Attributes:
        name: fixed by the contract.
        kind: the platform kind it belongs to.
        acts_on: what the diagnosis reports (`force`, `torque`, `actuator`, `command`, `measurement`, `drive`, ...).
        parameters: the numbers to identify.
        needs: signals that the effect requires to be simulated and tested.
        excluded_by: signals beside which it can be neither simulated nor tested.
        driver: the slow signal among them that may be estimated if it was not recorded.
        driver_is_late: whether its load changes the driver late only.
        driver_at_rest: the parameter, or the constant of the platform, that holds the driver's value at which the
            effect does nothing.
        formula: the law, as in a textbook.
        source: the publication or principle behind the law.
        sentence: the statement in a diagnosis, with `{name}` for a parameter's value and `{name_unit}` for its unit.
        symptom: how the effect shows in a log, one sentence.
        excitation: the manoeuvre that shows it and separates it from its look-alikes, in the imperative.
        look_alikes: names of further effects that a poor recording cannot separate from this one.
    """

    name: ClassVar[str]
    kind: ClassVar[str]
    acts_on: ClassVar[str]
    parameters: ClassVar[tuple[Parameter, ...]]
    needs: ClassVar[tuple[str, ...]] = ()
    excluded_by: ClassVar[tuple[str, ...]] = ()
    driver: ClassVar[str] = ""
    driver_is_late: ClassVar[bool] = False
    driver_at_rest: ClassVar[str] = ""
    prior_odds: ClassVar[float] = 0.15
    """Odds that a machine of the kind has the effect to a notable degree and its model lacks it."""
    kinked: ClassVar[bool] = False
    """Whether the law has a kink between the values of `starts`, which a gradient-based fit cannot cross."""
    formula: ClassVar[str]
    source: ClassVar[str]
    sentence: ClassVar[str]
    symptom: ClassVar[str]
    excitation: ClassVar[str]
    look_alikes: ClassVar[tuple[str, ...]] = ()
    names_physics: ClassVar[bool] = True
    """Whether a diagnosis may name it. It may not name a sum of terms that would absorb other effects, nor a finer law
    of an effect that has a name already."""

    names_its_subject: ClassVar[bool] = False
    """Whether the name of a swerve drive's effect says what it is about, so that the group adds nothing."""

    drifts: ClassVar[bool] = False
    """Whether heat and wear change it slowly while a machine runs, as they do friction and the strength of a motor."""

    trends: bool = False
    """Whether it is the part of an effect that grows or fades, see `simgap.equations.trend`."""

    @property
    def key(self) -> str:
        """The unique name within a kind; a swerve drive's effects carry their group, as in `backlash@steer`."""
        key = f"{self.name}@{self.acts_on}" if self.kind == "swerve" else self.name
        return f"trend of {key}" if self.trends else key

    def defaults(self) -> dict[str, float]:
        """Return a realistic value for each parameter."""
        return {parameter.name: parameter.default for parameter in self.parameters}

    def neutral(self) -> dict[str, float]:
        """Return the values at which the effect does nothing."""
        return {parameter.name: parameter.neutral for parameter in self.parameters}

    def completed(self, values: Mapping[str, Any]) -> dict[str, Any]:
        """Return values with the neutral one of each optional parameter that they leave out."""
        absent = {p.name: p.neutral for p in self.parameters if p.optional and p.name not in values}
        return {**values, **absent}

    def fits(self, constants: Values) -> bool:
        """Whether a platform with these constants may have the effect."""
        return True

    def load(self, signals: Signals, constants: Values) -> Signal | None:
        """Return the load that changes the effect's driver, at once or late, in any unit, or None if there is none."""
        return None

    def starts(self) -> list[dict[str, float]]:
        """Return starting values of a fit: several if the cost has several local minima.

        They are those of a machine of the sizes 1 (see `simgap.effects.sizes`).
        """
        return [self.neutral()]

    def starts_in(self, signals: Signals, constants: Values | None = None) -> list[dict[str, float]]:
        """Return the starting values for a recorded machine.

        Args:
            signals: recorded, (blocks, samples, ...).
            constants: of its platform; without them the effort that a voltage gives is taken to be 1.
        """
        sizes = sizes_of(self.kind, signals, constants or {})
        factor = {parameter.name: parameter.size_in(sizes) for parameter in self.parameters}
        return [{name: factor[name] * value for name, value in start.items()} for start in self.starts()]

    def parameters_in(self, signals: Signals, constants: Values | None = None) -> tuple[Parameter, ...]:
        """Return the parameters with the default and the bounds that suit a recorded machine; see `starts_in`."""
        sizes = sizes_of(self.kind, signals, constants or {})
        return tuple(parameter.of_size(sizes) for parameter in self.parameters)

    def odds_in(self, constants: Values) -> float:
        """Return the prior odds beside what a platform says; where its numbers do not matter, the `prior_odds`."""
        return self.prior_odds

    def lateness(self, values: Values, constants: Values) -> float:
        """Return the delay that the effect causes, s; 0 if it has no timing."""
        return 0.0

    def stands_for(self, values: Values, constants: Values) -> float:
        """Return by which share a number of the platform would be off to do the same; infinite where none does."""
        return math.inf

    def subject(self, values: Values) -> str:
        """Return what the name is about: the number of a rotor or module, a group, a sensor; "" if the name says that.

        Args:
            values: of the parameters.
        """
        if self.kind != "swerve" or self.names_its_subject:
            return ""
        return "" if self.acts_on == "chassis" else self.acts_on

    def units(self, position_unit: str = "rad") -> dict[str, str]:
        """Return the unit of each parameter; on a sliding axis N·m becomes N and rad becomes m."""
        units = {parameter.name: parameter.unit for parameter in self.parameters}
        if position_unit == "rad":
            return units
        return {name: unit.replace("N·m", "N").replace("rad", "m") for name, unit in units.items()}

    def statement(self, values: Mapping[str, float], position_unit: str = "rad") -> str:
        """Return the sentence with the values and units filled in."""
        filled = {name: f"{value:.3g}" for name, value in values.items()}
        filled |= {f"{name}_unit": unit for name, unit in self.units(position_unit).items()}
        return self.sentence.format(**filled)


class WrenchEffect(Effect):
    """A force or torque as a function of state and actuator."""

    linear: ClassVar[bool] = True
    """Whether the wrench is linear in the parameters, which makes identification a least-squares problem."""
    takes_share: ClassVar[bool] = False
    """Whether it takes a share of what the actuators exert, as a gear does; otherwise it is a load beside them."""

    @abstractmethod
    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the contribution to each channel of the platform's equations of motion, in that channel's unit."""

    def regressors(self, signals: Signals, constants: Values) -> list[Channels]:
        """Return the wrench per unit of each parameter of a linear effect."""
        names = [parameter.name for parameter in self.parameters]
        return [
            self.wrench(signals, {other: float(other == name) for other in names}, constants)
            for name in names
        ]


class ActuatorEffect(Effect):
    """A change in how a command becomes rotor speed, torque or voltage, with or without an internal state.

    The state is called `memory` and is None before the first sample. An effect without a state returns None and accepts
    whole blocks of time. An effect whose internal state acts on the body, such as a swinging payload, is two in one: an
    actuator effect that adds a hidden signal, and a wrench effect that reads it.
    """

    remembers: ClassVar[bool] = False
    smooths_commands: ClassVar[bool] = False
    """Whether it smooths steps of the command."""
    order: ClassVar[int] = 0
    """Order of application from supply to load: 0 supply, 1 electrical, 2 mechanical, 3 follows from the motion."""

    @abstractmethod
    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the changed signals at this sample, and the memory for the next."""

    def along_time(
        self, signals: Signals, values: Values, constants: Values, time_step: float
    ) -> dict[str, Signal]:
        """Return the signals of recorded blocks (blocks, samples, ...) as the effect changes them.

        The default runs `actuate` sample by sample if the effect has a state, and on whole blocks if it has none.
        """
        if not self.remembers:
            return {**signals, **self.actuate(signals, values, constants, None, time_step)[0]}
        return {**signals, **_scan(self, signals, values, constants, time_step)}


class CommandEffect(ActuatorEffect):
    """A map or filter from command to command, applied before the actuator."""


class MeasurementEffect(Effect):
    """A map from the true state to what was recorded."""

    @abstractmethod
    def undo(self, signals: Signals, values: Values, time_step: float) -> dict[str, Signal]:
        """Return the signals without the effect; time is dimension 1."""


class ConstantEffect(Effect):
    """A change of numbers in the nominal equations."""

    @abstractmethod
    def adjust(self, constants: Values, values: Values) -> dict[str, Any]:
        """Return the constants as the effect changes them."""


class ParameterError(ConstantEffect):
    """Wrong numbers in the platform file; each parameter is a ratio of true to nominal."""

    spread: ClassVar[float] = 0.3
    """Standard deviation of the ratio's logarithm: how well the number is known before anything is recorded."""
    acts_on: ClassVar[str] = "parameter"
    parameters: ClassVar[tuple[Parameter, ...]] = (Parameter("ratio", "1", 1.2, 1 / 3, 3.0, neutral=1.0),)


def _scan(
    effect: ActuatorEffect, signals: Signals, values: Values, constants: Values, time_step: float
) -> dict[str, Tensor]:
    memory: Any = None
    changed: dict[str, list[Tensor]] = {}
    names, samples = list(signals), zip(*(series.unbind(1) for series in signals.values()), strict=True)
    for sample in samples:
        now = dict(zip(names, sample, strict=True))
        out, memory = effect.actuate(now, values, constants, memory, time_step)
        for name, value in out.items():
            changed.setdefault(name, []).append(value)
    return {name: torch.stack(steps, dim=1) for name, steps in changed.items()}
