"""The hidden state of a machine between two calls."""

import torch

from simgap.errors import InputError
from simgap.simulation.actuation import Memory as Remembered

_SAME = 1e-9  # share by which two time steps may differ by rounding


class Memory:
    """What the effects of a machine remember between calls: rotor speeds behind a lag, play, commands on their way.

    A new one is that of a machine that has held its first command for long. `Machine.step` and `Machine.rollout`
    replace what it holds. It belongs to one batch of machines and to one time step.

    Attributes:
        effects: what each effect that remembers remembers; empty before the first call.
    """

    def __init__(self) -> None:
        """Remember nothing yet."""
        self.effects: Remembered = ()
        self._of: tuple[tuple[int, ...], float] | None = None

    def copy(self) -> "Memory":
        """Return a memory that goes on from here on its own, for example to try out several commands."""
        other = Memory()
        other.effects, other._of = self.effects, self._of
        return other

    def of(self, batch: torch.Size, time_step: float) -> "Memory":
        """Return this memory for a batch of machines and an integration step, s.

        Raises:
            InputError: when it belongs to others.
        """
        now = tuple(batch), time_step
        machines, before = self._of or now
        if machines != now[0]:
            raise InputError(
                f"memory is of machines {machines}; got {now[0]}", remedy="use one memory per batch"
            )
        if abs(before - time_step) > _SAME * before:
            remedy = "keep dt and substeps while a memory is used"
            raise InputError(
                f"memory is of integration steps of {before:g} s; got {time_step:g} s", remedy=remedy
            )
        self._of = now
        return self
