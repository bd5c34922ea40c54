"""What an effect is: one piece of physics, written once, for simulator, diagnosis, report and documentation.

An effect acts in one of the places along command → actuator → wrench → measurement, or it corrects a number of the
platform. Its place is its type. All functions take tensors whose leading dimensions are free (a batch of simulated
machines, or blocks of a recording), so that the simulator and the diagnosis run the same code.
"""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import torch
from torch import Tensor

from simgap.physics.shapes import Channels, Signal, Signals

Values = Mapping[str, Any]
"""Parameter values (numbers or tensors), or constants of a platform, by name."""


@dataclass(frozen=True)
class Parameter:
    """A number of an effect.

    Attributes:
        name: full word.
        unit: as written in the diagnosis.
        default: a realistic size, in `unit`.
        low: least value that physics allows.
        high: greatest value that is believable.
        neutral: the value at which the effect does nothing.
    """

    name: str
    unit: str
    default: float
    low: float
    high: float
    neutral: float = 0.0


class Effect(ABC):
    """A piece of physics that a nominal simulator may lack.

    Attributes:
        name: fixed by the contract.
        kind: the platform kind it belongs to.
        acts_on: what the diagnosis reports (`force`, `torque`, `actuator`, `command`, `measurement`, `drive`, ...).
        parameters: what is to be identified.
        needs: signals without which it can be neither simulated nor tested.
        driver: a slow one among them, which may be estimated where it was not recorded.
        driver_at_rest: the parameter, or constant of the platform, that is the driver's value where the effect does
            nothing.
        formula: as a person would write it.
        source: where it comes from.
        sentence: what a person can act on; `{name}` is replaced by the value of a parameter, `{name_unit}` by its unit.
        excitation: the manoeuvre that shows it.
    """

    name: ClassVar[str]
    kind: ClassVar[str]
    acts_on: ClassVar[str]
    parameters: ClassVar[tuple[Parameter, ...]]
    needs: ClassVar[tuple[str, ...]] = ()
    driver: ClassVar[str] = ""
    driver_at_rest: ClassVar[str] = ""
    yields_to: ClassVar[tuple[str, ...]] = ()
    """Names that are the likelier cause wherever a recording cannot tell this effect from them."""
    twins: ClassVar[tuple[str, ...]] = ()
    """Names that say the same in other words beside what else is named, however well either predicts."""
    usual: ClassVar[bool] = False
    """Whether any machine of the kind has it, so that a platform's wrong numbers may show only beside it."""
    kinked: ClassVar[bool] = False
    """Whether its law has a kink between the values that `starts` returns: a fit does not cross it by its slopes."""
    formula: ClassVar[str]
    source: ClassVar[str]
    sentence: ClassVar[str]
    excitation: ClassVar[str]
    names_physics: ClassVar[bool] = True
    """Whether a diagnosis may name it: not a bundle of terms that would absorb the others, nor a finer law of what
    another effect names already."""

    @property
    def key(self) -> str:
        """The name that is unique inside a kind: an effect in two groups of a swerve drive is two entries."""
        return f"{self.name}@{self.acts_on}" if self.kind == "swerve" else self.name

    def defaults(self) -> dict[str, float]:
        """Return a realistic value for each parameter."""
        return {parameter.name: parameter.default for parameter in self.parameters}

    def neutral(self) -> dict[str, float]:
        """Return the values at which the effect does nothing."""
        return {parameter.name: parameter.neutral for parameter in self.parameters}

    def load(self, signals: Signals, constants: Values) -> Signal | None:
        """Return what makes the effect's driver give way at once, in any unit, or None where nothing does."""
        return None

    def starts(self) -> list[dict[str, float]]:
        """Return values from which a fit may start; more than one where the cost has several valleys."""
        return [self.neutral()]

    def starts_in(self, signals: Signals) -> list[dict[str, float]]:
        """Return the same for what was recorded, where that says how wide the valleys are."""
        return self.starts()

    def limit(self, values: Values, signals: Signals, constants: Values) -> str:
        """Return the name of the effect that this one comes down to at its values in what was recorded, or ""."""
        return ""

    def unphysical(self, values: Values, constants: Values) -> str:
        """Return why no machine of the kind has these values though each is within its bounds, or ""."""
        return ""

    def lateness(self, values: Values, constants: Values) -> float:
        """Return by how much the effect makes something late, s; 0 where it is not about time."""
        return 0.0

    def units(self, position_unit: str = "rad") -> dict[str, str]:
        """Return the unit of each parameter; on a sliding axis N·m becomes N and rad becomes m."""
        units = {parameter.name: parameter.unit for parameter in self.parameters}
        if position_unit == "rad":
            return units
        return {name: unit.replace("N·m", "N").replace("rad", "m") for name, unit in units.items()}

    def statement(self, values: Mapping[str, float], position_unit: str = "rad") -> str:
        """Return the sentence for people; `{name}` becomes the value, `{name_unit}` its unit."""
        filled = {name: f"{value:.3g}" for name, value in values.items()}
        filled |= {f"{name}_unit": unit for name, unit in self.units(position_unit).items()}
        return self.sentence.format(**filled)


class WrenchEffect(Effect):
    """A force or torque as a function of state and actuator."""

    linear: ClassVar[bool] = True
    """Whether the wrench is linear in the parameters, which makes identification a least-squares problem."""

    @abstractmethod
    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return what is added to each channel of the platform's balance, in that channel's unit."""

    def regressors(self, signals: Signals, constants: Values) -> list[Channels]:
        """Return, for each parameter of a linear effect, the wrench per unit of it."""
        names = [parameter.name for parameter in self.parameters]
        return [
            self.wrench(signals, {other: float(other == name) for other in names}, constants)
            for name in names
        ]


class ActuatorEffect(Effect):
    """A change in how a command becomes rotor speed, torque or voltage; may remember.

    `memory` is None before the first sample; a memoryless effect returns None and may be given whole blocks of time.
    An effect with a hidden state of its own that pushes on the body (a swinging payload) is an actuator effect that
    adds its hidden signal and a wrench effect that reads it.
    """

    remembers: ClassVar[bool] = False
    smooths_commands: ClassVar[bool] = False
    """Whether it passes on less of a command that jumps."""
    order: ClassVar[int] = 0
    """Place on the way from supply to load: 0 supply, 1 electrical, 2 mechanical, 3 what follows from the motion."""

    @abstractmethod
    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the changed signals at this sample, and the memory for the next."""

    def along_time(
        self, signals: Signals, values: Values, constants: Values, time_step: float
    ) -> dict[str, Signal]:
        """Return the signals of recorded blocks (blocks, samples, ...) as the effect changes them.

        The default runs `actuate` sample by sample where the effect remembers, and at once where it does not.
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
        """Return the signals as they would have been recorded without the effect; time is dimension 1."""


class ConstantEffect(Effect):
    """A change of numbers in the nominal equations."""

    @abstractmethod
    def adjust(self, constants: Values, values: Values) -> dict[str, Any]:
        """Return the constants as the effect changes them."""


class ParameterError(ConstantEffect):
    """A number of the platform that is wrong; the parameter is the ratio of true over nominal."""

    acts_on: ClassVar[str] = "parameter"
    parameters = (Parameter("ratio", "1", 1.2, 1 / 3, 3.0, neutral=1.0),)


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
