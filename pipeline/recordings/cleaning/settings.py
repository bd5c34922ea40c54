"""Settings of cleaning."""

from dataclasses import dataclass

from simgap.errors import InputError


@dataclass
class Cleaning:
    """Limits by which a recording is cleaned.

    Attributes:
        time_step: s between two samples afterwards; None takes the one most samples have.
        max_gap: s; missing samples are interpolated when those around them are no farther apart, else the run
            is split.
        max_slow_gap: s; the same for battery voltage and temperature, which change slowly.
        jitter: share of the time step by which a sample may be early or late and still counts as on time.
        min_duration: s; shorter stretches are dropped.
        min_measured: share of its samples that an unbroken stretch must have measured in every needed
            channel.
        min_idle: s; a shorter rest is left in.
        spikes: whether isolated impossible samples are replaced.
        frozen: whether samples that were repeated for want of a newer one are replaced.
        crash: whether a run is cut off before its crash.
        crash_margin: s cut off before the first sign of a crash.
        idle: whether stretches without any input and motion are dropped.
        max_clock_offset: s; clocks are searched this far apart.
    """

    time_step: float | None = None
    max_gap: float = 0.1
    max_slow_gap: float = 2.0
    jitter: float = 0.05
    min_duration: float = 0.1
    min_measured: float = 0.5
    min_idle: float = 0.5
    spikes: bool = True
    frozen: bool = True
    crash: bool = True
    crash_margin: float = 0.5
    idle: bool = True
    max_clock_offset: float = 0.1

    def check(self) -> None:
        """Check the ranges of the limits.

        Raises:
            InputError: naming the key.
        """
        if self.time_step is not None and self.time_step <= 0:
            raise InputError(
                f"must be positive, is {self.time_step}", "clean.time_step", "give seconds, or null"
            )
        for key in (
            "max_gap",
            "max_slow_gap",
            "jitter",
            "min_duration",
            "min_measured",
            "min_idle",
            "crash_margin",
        ):
            if getattr(self, key) < 0:
                raise InputError(
                    f"must not be negative, is {getattr(self, key)}", f"clean.{key}", "give seconds"
                )
        for key, most in (("jitter", 0.5), ("min_measured", 1.0)):
            if getattr(self, key) >= most:
                raise InputError(
                    f"must be below {most}, is {getattr(self, key)}", f"clean.{key}", "give a share"
                )
        if self.max_clock_offset <= 0:
            raise InputError("must be positive", "clean.max_clock_offset", "give seconds")
