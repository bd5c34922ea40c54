"""Transport delay of commands."""

import numpy as np

from simgap.plants.rotation import Array


class Commands:
    """What was commanded so far, and what of it has arrived."""

    def __init__(self, delay: float, step: float, shape: tuple[int, ...]) -> None:
        """Keep a series of that shape (steps, ...), one entry every `step` s; what arrives is `delay` s old."""
        self.late = delay / step
        self.series = np.zeros(shape)

    def note(self, count: int, command: Array) -> None:
        """Note the command of a step."""
        self.series[count] = command

    def keep(self, count: int) -> None:
        """Repeat the command of the step before."""
        self.series[count] = self.series[count - 1]

    def at(self, count: int) -> Array:
        """Return the command that arrives at a step, in between two.

        Where commands are held from step to step, it is the mean of what arrives until the next one.
        """
        place = max(count - self.late, 0.0)
        whole = int(place)
        share = place - whole
        if share == 0.0:
            return self.series[whole]
        return (1.0 - share) * self.series[whole] + share * self.series[whole + 1]
