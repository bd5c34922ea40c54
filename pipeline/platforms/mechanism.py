"""Interface of nominal mechanisms, for the simulator and the diagnosis."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from simgap.physics.shapes import Channels, Real, Signal, Signals

Constants = Mapping[str, Any]


@dataclass(frozen=True)
class Channel:
    """One equation: a momentum balance, or the agreement of two measurements of one quantity.

    Attributes:
        name: as in the diagnosis, for example `force_x`.
        unit: of the wrench, or of the quantity.
        group: what kind of effect acts here (`force`, `torque`, `drive`, `steer`), or which readings have to agree
            (`actuator`, `rolling`).
        tolerance: usual RMS difference of the two sides on a machine without a fault.
    """

    name: str
    unit: str
    group: str
    tolerance: float = 0.0


class Mechanism(ABC):
    """The nominal physics of one platform kind.

    The rate of `momentum` equals `wrench` + `inertial` in each channel. Effects add to the wrench. `constrain` removes
    the part that bearings and wheels take up. All methods take signals with free leading dimensions.
    """

    kind: ClassVar[str]
    channels: tuple[Channel, ...]
    actuator_signals: ClassVar[tuple[str, ...]]
    """Signals on the clock of the command; a sensor time offset shifts them against the rest."""
    actuator_output: ClassVar[str] = ""
    """The actuator's output signal, which a recording may hold; empty if it is never recorded."""
    actuator_input: ClassVar[str] = ""
    exerted: ClassVar[tuple[str, ...]]
    """Signals of what actuators exert on the machine: without them only the rest acts."""

    def channels_of(self, signals: Signals) -> tuple[Channel, ...]:
        """Return the equations that these signals can test; a recorded actuator output adds some."""
        return self.channels

    def readings(self, signals: Signals, constants: Constants) -> dict[str, tuple[Real, Real]]:
        """Return the measured value and its prediction from other signals, for each channel without a momentum."""
        return {}

    def given_output(self, signals: Signals) -> str | None:
        """Return the name of the actuator's output if the signals hold it, else None."""
        return self.actuator_output if self.actuator_output in signals else None

    @abstractmethod
    def constants(self) -> dict[str, Any]:
        """Return the numbers of the nominal equations, which parameter errors scale."""

    @abstractmethod
    def actuate(self, signals: Signals, constants: Constants) -> dict[str, Signal]:
        """Return the signals with the nominal actuator's output (`rotor_speed`, `effort`) added."""

    @abstractmethod
    def wrench(self, signals: Signals, constants: Constants) -> Channels:
        """Return the wrench of actuators and nominal environment, per channel."""

    def loads(self, wrench: Mapping[str, Real], signals: Signals) -> dict[str, Signal]:
        """Return the loads on bodies with dry friction, as signals; empty without dry friction."""
        return {}

    def free_inertia(self, signals: Signals) -> Channels:
        """Return the share of each channel's inertia that a motor in a gap has to itself (absent where there is none).

        The motion that was recorded is that of the rest, whose equation has terms that are smaller by this share.
        """
        return {}

    def derived(self, signals: Signals, constants: Constants) -> dict[str, Signal]:
        """Return shared intermediate results of several equations, as further signals."""
        return {}

    def constrain(self, wrench: Mapping[str, Real], signals: Signals, constants: Constants) -> Channels:
        """Return a wrench after the constraint forces; absent channels are zero."""
        return dict(wrench)

    @abstractmethod
    def inertial(self, signals: Signals, constants: Constants) -> Channels:
        """Return gravity and the terms of a rotating frame, constrained, per channel (absent if zero)."""

    @abstractmethod
    def momentum(self, signals: Signals, constants: Constants) -> Channels:
        """Return the quantity whose rate balances the wrench, per channel."""

    def damping(self, constants: Constants) -> dict[str, float]:
        """Return the damping rate of each channel's velocity, 1/s (absent if undamped)."""
        return {}

    @abstractmethod
    def inertia(self, constants: Constants) -> dict[str, float]:
        """Return the inertia of each channel, momentum per velocity, which a parameter error may scale."""
