"""Time offset between the clocks of state and commands, for every kind of platform."""

from typing import ClassVar

from simgap.effects.effect import MeasurementEffect, Parameter, Signals, Values
from simgap.effects.shift import shift_in_time
from simgap.physics.shapes import Signal


class TimeOffset(MeasurementEffect):
    """The state is recorded late relative to the commands, or early if the offset is negative."""

    on_command_clock: ClassVar[tuple[str, ...]]
    """The signals on the clock of the commands, if present."""

    late: ClassVar[str] = "state"
    """What is recorded late."""

    name = "sensor_time_offset"
    acts_on = "measurement"
    parameters = (Parameter("offset", "s", 0.02, -0.1, 0.1),)
    formula = "recorded(t) = true(t − offset)"
    source = (
        "Furgale, Rehder & Siegwart 2013, Unified temporal and spatial calibration for multi-sensor systems"
    )
    sentence = (
        "The state was recorded {offset} s late relative to the motors; shift the clocks before you fit "
        "anything."
    )
    symptom = "Accelerations appear later or earlier in the log than the commands that cause them."
    look_alikes = ("command_delay",)

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan: a periodic motion has a local minimum at each period."""
        return [{"offset": offset} for offset in (-0.06, -0.03, 0.0, 0.03, 0.06)]

    def lateness(self, values: Values, constants: Values) -> float:
        """Return the offset."""
        return float(values["offset"])

    def subject(self, values: Values) -> str:
        """Return what is recorded late."""
        return self.late

    def undo(self, signals: Signals, values: Values, time_step: float) -> dict[str, Signal]:
        """Delay the motors' signals by the offset so that both clocks agree.

        Where the runs' clocks differ, `clock_deviation` holds each block's deviation from the common offset.
        """
        offset = values["offset"]
        if "clock_deviation" in signals:
            offset = offset + signals["clock_deviation"][:, 0]
        shifted = {
            name: shift_in_time(signals[name], offset, time_step)
            for name in self.on_command_clock
            if name in signals
        }
        return {**signals, **shifted}
