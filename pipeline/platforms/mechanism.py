"""Interface of nominal mechanisms, for the simulator and the diagnosis."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from torch import Tensor

Signals = Mapping[str, Tensor]
Constants = Mapping[str, Any]


@dataclass(frozen=True)
class Channel:
    """One equation: the rate of a momentum equals what acts on it, or two readings of one quantity agree.

    Attributes:
        name: as in the diagnosis, for example `force_x`.
        unit: of the wrench, or of the quantity.
        group: what kind of effect acts here (`force`, `torque`, `drive`, `steer`), or which readings have to agree
            (`actuator`, `rolling`).
        tolerance: by how much, RMS, the two sides may differ on any machine without anything being amiss.
    """

    name: str
    unit: str
    group: str
    tolerance: float = 0.0


class Mechanism(ABC):
    """The nominal physics of one platform kind.

    The rate of `momentum` equals `wrench` + `inertial`, channel by channel. Effects add to the wrench, of which
    `constrain` keeps what the machine's bearings and wheels leave of it.
    All methods take signals with free leading dimensions.
    """

    kind: ClassVar[str]
    channels: tuple[Channel, ...]
    actuator_signals: ClassVar[tuple[str, ...]]
    """Signals on the clock of the command: what a time offset of the sensors moves against the rest."""
    actuator_output: ClassVar[str] = ""
    """What the actuator makes of the command and a recording may hold as well; empty where none is ever recorded."""
    actuator_input: ClassVar[str] = ""

    def channels_of(self, signals: Signals) -> tuple[Channel, ...]:
        """Return the equations that these signals can be held against: more where an actuator's output is recorded."""
        return self.channels

    def readings(self, signals: Signals, constants: Constants) -> dict[str, tuple[Tensor, Tensor]]:
        """Return what was read and what the other signals say it must be, for each channel that holds no momentum."""
        return {}

    def given_output(self, signals: Signals) -> str | None:
        """Return the actuator's output where it is among the signals: then nothing has to be made of the command."""
        return self.actuator_output if self.actuator_output in signals else None

    @abstractmethod
    def constants(self) -> dict[str, Any]:
        """Return the numbers of the nominal equations, which parameter errors scale."""

    @abstractmethod
    def actuate(self, signals: Signals, constants: Constants) -> dict[str, Tensor]:
        """Return the signals with the nominal actuator's output (`rotor_speed`, `effort`) added."""

    @abstractmethod
    def wrench(self, signals: Signals, constants: Constants) -> dict[str, Tensor]:
        """Return what the actuators and the nominal environment do, per channel."""

    def loads(self, wrench: Mapping[str, Tensor], signals: Signals) -> dict[str, Tensor]:
        """Return what acts on each thing that dry friction may hold, as signals; none where nothing rubs."""
        return {}

    def derived(self, signals: Signals, constants: Constants) -> dict[str, Tensor]:
        """Return what several of the equations need of the signals, as further signals, lest each work it out again."""
        return {}

    def constrain(
        self, wrench: Mapping[str, Tensor], signals: Signals, constants: Constants
    ) -> dict[str, Tensor]:
        """Return what is left of a wrench once forces of constraint have answered it; absent channels are zero."""
        return dict(wrench)

    @abstractmethod
    def inertial(self, signals: Signals, constants: Constants) -> dict[str, Tensor]:
        """Return gravity and the terms of a turning frame, constrained, per channel (absent where zero)."""

    @abstractmethod
    def momentum(self, signals: Signals, constants: Constants) -> dict[str, Tensor]:
        """Return the quantity whose rate balances the wrench, per channel."""

    def damping(self, constants: Constants) -> dict[str, float]:
        """Return the rate at which each channel's velocity settles by itself, 1/s (absent where it does not)."""
        return {}

    @abstractmethod
    def inertia(self, constants: Constants) -> dict[str, float]:
        """Return what the momentum is per unit of velocity, per channel: what a parameter error may rescale."""
