"""A simulator: platform, nominal mechanism and effects, evaluated on simulated or on recorded signals."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from torch import Tensor

from simgap.effects import (
    ActuatorEffect,
    CommandEffect,
    ConstantEffect,
    DryFriction,
    Effect,
    MeasurementEffect,
    WrenchEffect,
)
from simgap.physics.shapes import Channels, Signal, Signals
from simgap.platforms import Platform
from simgap.platforms.mechanism import Mechanism
from simgap.platforms.mechanisms import mechanism_of
from simgap.simulation.learned import Learned

_LAST_OF_THE_ACTUATOR = 2  # order of an effect; those behind it do not change what the actuator puts out


@dataclass(frozen=True)
class FittedEffect:
    """An effect with the values it has in one simulator.

    Attributes:
        effect: the entry of the catalogue.
        values: parameter values in the effect's units; tensors where a gradient is wanted.
        std: standard errors, empty where the values were set by hand.
        known: whether the effect was believed before any diagnosis, which then holds its values.
    """

    effect: Effect
    values: Mapping[str, Any]
    std: Mapping[str, float] = field(default_factory=dict)
    known: bool = False


@dataclass(frozen=True)
class Balance:
    """Both sides of the equations of motion, per channel.

    Attributes:
        momentum: the quantity whose rate is balanced.
        wrench: what acts on it: what an ideal accelerometer or torque sensor would read.
        rate: the wrench, gravity and the terms of a turning frame.
    """

    momentum: Channels
    wrench: Channels
    rate: Channels


@dataclass(frozen=True)
class Simulator:
    """A platform with its nominal mechanism and effects.

    Attributes:
        platform: what a person knew before identification.
        effects: the effects that act, with their values.
        position_unit: of a joint, rad or m.
        settings: constants that are not physics but resolution, such as `sliding_velocity`.
        learned: the model that moves it in the place of its physics, or that adds what they leave; None: physics alone.
    """

    platform: Platform
    effects: tuple[FittedEffect, ...] = ()
    position_unit: str = "rad"
    settings: Mapping[str, float] = field(default_factory=dict)
    learned: Learned | None = None

    @cached_property
    def mechanism(self) -> Mechanism:
        """The nominal mechanism of the platform."""
        return mechanism_of(self.platform, self.position_unit)

    @property
    def free(self) -> tuple[FittedEffect, ...]:
        """The effects whose values a fit may change."""
        return tuple(fitted for fitted in self.effects if not fitted.known)

    @property
    def known(self) -> tuple[FittedEffect, ...]:
        """The effects that were believed before."""
        return tuple(fitted for fitted in self.effects if fitted.known)

    def of_type(self, kind: type[Effect]) -> list[FittedEffect]:
        """Return the effects that act in one place, in the order in which they act."""
        chosen = [fitted for fitted in self.effects if isinstance(fitted.effect, kind)]
        return sorted(chosen, key=lambda fitted: getattr(fitted.effect, "order", 0))

    def with_effects(self, effects: tuple[FittedEffect, ...]) -> "Simulator":
        """Return the same platform with other effects."""
        return replace(self, effects=effects)

    def nominal_inertia(self) -> dict[str, float]:
        """Return each channel's inertia as the platform file has it."""
        return self.mechanism.inertia(self.mechanism.constants())

    def constants(self) -> dict[str, Any]:
        """Return the constants of the platform as the effects change them."""
        constants: dict[str, Any] = {**self.mechanism.constants(), **self.settings}
        for fitted in self.of_type(ConstantEffect):
            constants = fitted.effect.adjust(constants, fitted.values)  # type: ignore[attr-defined]
        return constants

    def along_time(self, signals: Signals, time_step: float) -> dict[str, Signal]:
        """Return recorded blocks (blocks, samples, ...) with everything up to the actuator applied.

        Clock offsets are undone, commands delayed, the nominal actuator and the actuator effects run. Where the
        actuator's output was recorded beside its command it is kept, and what the command makes of it is added as
        `commanded_*`.
        """
        constants, out = self.constants(), dict(signals)
        for fitted in self.of_type(MeasurementEffect):
            out = fitted.effect.undo(out, fitted.values, time_step)  # type: ignore[attr-defined]
        for fitted in self.of_type(CommandEffect):
            out = _along_time(fitted, out, constants, time_step)
        given = self.mechanism.given_output(out)
        if given is None or self.mechanism.actuator_input not in out:
            return self._actuated_along_time(out, constants, time_step, given)
        bare = {name: series for name, series in out.items() if name != given}
        moving = self.with_effects(tuple(f for f in self.effects if not _follows_motion(f)))
        commanded = moving._actuated_along_time(bare, constants, time_step, None)[given]
        measured = self._actuated_along_time(out, constants, time_step, given)
        return {**measured, f"commanded_{given}": commanded}

    def _actuated_along_time(
        self, signals: dict[str, Tensor], constants: dict[str, Any], time_step: float, given: str | None
    ) -> dict[str, Tensor]:
        out = self.mechanism.actuate(signals, constants)
        for fitted in self.of_type(ActuatorEffect):
            if not isinstance(fitted.effect, CommandEffect):
                changed = _along_time(fitted, out, constants, time_step)
                out = {**changed, given: out[given]} if given else changed
        return out

    def wrench(self, signals: Signals, constants: Mapping[str, Any]) -> Channels:
        """Return what acts, per channel, before constraints answer it, for signals that went through the actuator."""
        wrench = self.mechanism.wrench(signals, constants)
        for fitted in self.of_type(WrenchEffect):
            if not isinstance(fitted.effect, DryFriction):
                added = fitted.effect.wrench(signals, fitted.values, constants)  # type: ignore[attr-defined]
                wrench = _sum(wrench, added)
        return self._rubbed(wrench, signals, constants)

    def _rubbed(
        self, wrench: dict[str, Tensor], signals: Signals, constants: Mapping[str, Any]
    ) -> dict[str, Tensor]:
        """Add dry friction, each of what is left to be held once all else and the ones before it have acted."""
        rubbing = self.of_type(DryFriction)
        loads = self.mechanism.loads(wrench, signals) if rubbing else {}
        for fitted in rubbing:
            effect = fitted.effect
            assert isinstance(effect, DryFriction)
            friction = effect.friction(
                {**signals, **loads}, effect.values_now(signals, fitted.values), constants
            )
            loads = {**loads, effect.holds: loads[effect.holds] + friction}
            wrench = _sum(wrench, effect.on_channels(friction, signals, constants))
        return wrench

    def is_linear_in(self, effect: Effect) -> bool:
        """Whether what acts is linear in an effect's parameters: no dry friction holds against what it does."""
        return isinstance(effect, WrenchEffect) and effect.linear and not self._holds(effect)

    def is_sum_with(self, effect: Effect) -> bool:
        """Whether an effect follows from the recorded motion alone and only adds to what acts."""
        changing = ActuatorEffect | ConstantEffect | MeasurementEffect | DryFriction
        if not isinstance(effect, WrenchEffect) or isinstance(effect, changing) or not effect.needs:
            return False
        return not self._holds(effect) and set(self.mechanism.actuator_signals).isdisjoint(effect.needs)

    def _holds(self, effect: Effect) -> bool:
        return any(f.effect.acts_on == effect.acts_on for f in self.of_type(DryFriction))

    def balance(self, signals: Signals) -> Balance:
        """Return both sides of the equations of motion for signals that went through the actuator."""
        constants, mechanism = self.constants(), self.mechanism
        signals = {**signals, **mechanism.derived(signals, constants)}
        wrench = mechanism.constrain(self.wrench(signals, constants), signals, constants)
        inertial = mechanism.inertial(signals, constants)
        rate = {name: value + inertial[name] if name in inertial else value for name, value in wrench.items()}
        return Balance(mechanism.momentum(signals, constants), wrench, rate)


def _sum(wrench: Mapping[str, Tensor], added: Mapping[str, Tensor]) -> dict[str, Tensor]:
    return {**wrench, **{name: wrench[name] + value for name, value in added.items()}}


def _follows_motion(fitted: FittedEffect) -> bool:
    return getattr(fitted.effect, "order", 0) > _LAST_OF_THE_ACTUATOR


def _along_time(
    fitted: FittedEffect, signals: dict[str, Tensor], constants: dict[str, Any], time_step: float
) -> dict[str, Tensor]:
    return fitted.effect.along_time(signals, fitted.values, constants, time_step)  # type: ignore[attr-defined]
