"""Integrator of the plants."""

from simgap.plants.rotation import Array


class AdamsBashforth:
    """The two-step rule, of second order: one evaluation per step.

    It puts no shift in time between force and motion that would look like a sensor's delay.
    """

    def __init__(self, step: float) -> None:
        """Take the step, s."""
        self.step = step
        self.before: Array | None = None

    def __call__(self, state: Array, rate: Array) -> Array:
        """Return the state a step later, from its rate of change now and a step ago."""
        mean = rate if self.before is None else 1.5 * rate - 0.5 * self.before
        self.before = rate
        return state + self.step * mean
