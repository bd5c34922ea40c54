"""What a diagnosis found, as values of a person's own program; the fields are those of `diagnosis.json`."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from types import UnionType
from typing import Any, get_args, get_origin, get_type_hints


@dataclass(frozen=True)
class Parameter:
    """A number of an effect.

    Attributes:
        value: as it enters the nominal equations, in `unit`; true over nominal for effects called `*_error`.
        std: its standard error, in `unit`.
        unit: for example `N·m`.
    """

    value: float
    std: float
    unit: str


@dataclass(frozen=True)
class Effect:
    """Physics that the nominal simulator lacks.

    Attributes:
        name: in the catalogue.
        probability: of being there, 0 to 1, an average over every explanation that was tried. Below 0.5 it is doubted.
        acts_on: `command`, `actuator`, `force`, `torque` or `measurement`; for a swerve drive `drive`, `steer` or
            `chassis`.
        parameters: by name.
        statement: what it is and what to do, one sentence.
        subject: what the name is about: the number of a rotor or module, a group, a sensor; None if the name says that.
        runs: in which it acts: a name each, or a mapping of `run` and `from` or `until`, s, where it begins or ends
            within that run; empty if it acts in all.
    """

    name: str
    probability: float
    acts_on: str
    parameters: Mapping[str, Parameter]
    statement: str
    subject: str | None = None
    runs: tuple[str | Mapping[str, Any], ...] = ()


@dataclass(frozen=True)
class Ambiguity:
    """Effects that this recording does not tell apart: one of them is there, hardly two at once.

    Attributes:
        names: of the effects; the one that was named comes first.
        separate_by: the manoeuvre that would tell them apart, one sentence.
        subjects: what each name is about, as the subject of an effect.
    """

    names: tuple[str, ...]
    separate_by: str
    subjects: tuple[str | None, ...] = ()


@dataclass(frozen=True)
class Size:
    """How large something is beside the noise.

    Attributes:
        value: its root mean square, in `unit`.
        noise: root mean square of the sensors' noise, in `unit`.
        unit: of both.
    """

    value: float
    noise: float
    unit: str


@dataclass(frozen=True)
class Unnamed:
    """Something that no effect of the catalogue accounts for.

    Attributes:
        channel: the equation in which it shows.
        depends_on: the signals that it follows.
        formula: that describes it.
        share: of the residual's energy, 0 to 1.
        size: of what the formula explains; None where it is not known.
    """

    channel: str
    depends_on: tuple[str, ...]
    formula: str
    share: float
    size: Size | None = None


@dataclass(frozen=True)
class Contradiction:
    """Something in which the recording contradicts itself or the platform, so that nothing is named.

    Attributes:
        column: of the recording, or a group as `motor_speed_1..4`.
        runs: in which it does.
        suspected: the cause, for example `degrees`, `sign` or `motor_order`.
        evidence: one sentence with figures.
        remedy: what to do, one sentence.
    """

    column: str
    runs: tuple[str, ...]
    suspected: str
    evidence: str
    remedy: str


@dataclass(frozen=True)
class Regime:
    """Where the nominal simulator fails most: a range of one variable, in its SI unit."""

    variable: str
    low: float
    high: float


@dataclass(frozen=True)
class Mismatch:
    """An equation in which the nominal simulator and the recording differ.

    Attributes:
        channel: the equation, for example `torque`.
        share: of the whole mismatch, 0 to 1.
        regime: where it is greatest.
        p_value: of the test against noise.
        where: the same as one sentence.
    """

    channel: str
    share: float
    regime: Regime
    p_value: float
    where: str


@dataclass(frozen=True)
class Fit:
    """How well the simulator explains the recording before and after, in the unit that `metric` names.

    Attributes:
        metric: what is compared, over which horizon, in which unit.
        held_out_runs: the runs that were used for nothing else.
        before: error of the nominal simulator on them.
        after: error of the diagnosed simulator.
        noise_floor: error that the sensors' noise alone would make.
        gap_closed: (before − after) / (before − noise_floor); None where no run could be held out.
        gap_closed_interval: 95 % interval of it; None where fewer than two runs were held out.
    """

    metric: str
    held_out_runs: tuple[str, ...]
    before: float
    after: float
    noise_floor: float
    gap_closed: float | None
    gap_closed_interval: tuple[float, float] | None


def built(hint: Any, value: Any) -> Any:
    """Return plain values as the dataclasses and tuples that a type says.

    Args:
        hint: the type; fields whose names begin with an underscore are taken as they are.
        value: of `diagnosis.json`.
    """
    if dataclasses.is_dataclass(hint):
        hints = _hints(hint)
        known = {entry.name: value[entry.name] for entry in dataclasses.fields(hint) if entry.name in value}
        return hint(**{name: built(hints.get(name), entry) for name, entry in known.items()})  # type: ignore[operator]
    arguments = get_args(hint)
    if get_origin(hint) is UnionType:  # with None, in which case there is nothing to build
        return None if value is None else built(arguments[0], value)
    if get_origin(hint) is tuple:
        return tuple(built(arguments[0], entry) for entry in value)
    if get_origin(hint) is Mapping:
        return {key: built(arguments[1], entry) for key, entry in value.items()}
    return value


def _hints(cls: Any) -> dict[str, Any]:
    """Return the types of the fields that `diagnosis.json` has."""
    return {name: hint for name, hint in get_type_hints(cls, None, {"Found": Any}).items() if name[0] != "_"}
