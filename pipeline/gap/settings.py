"""Settings of the diagnosis."""

from dataclasses import dataclass

from simgap.checks import check_not_negative, check_positive
from simgap.errors import InputError

_SHARES = ("least_share", "least_probability")
_LENGTHS = ("block_duration", "test_width", "horizon", "fit_horizon", "budget")
BELIEVED = 0.5
"""Probability from which an effect is more likely there than not."""
POSSIBLE = 0.05
"""Least posterior probability of an effect that counts as stated.

Below it lie hundreds of effects of the catalogue that nobody would name. They would outweigh the rest.
"""
BEYOND_NOISE = 4.0
"""Times the noise energy, above which a gap counts: coloured noise may reach it."""
_COUNT_KEYS = ("most_effects", "most_blocks", "resamples")


@dataclass
class Gap:
    """Settings of the gap engine."""

    effects: list[str] | None = None
    """Effects that may be missing; null: the whole catalogue of the platform kind."""
    block_duration: float = 1.0
    """Length of the stretches that a recording is cut into, s."""
    test_width: float = 0.2
    """Greatest width of the test functions that residuals are averaged with, s; fast motion gets narrower ones."""
    margin: float = 0.5
    """Time before a block in which effects with memory settle, s."""
    budget: float = 300.0
    """Greatest time of the search, s; then the best answer so far is given, marked as such."""
    least_share: float = 0.02
    """Least share of the excess over the noise floor that a formula must explain, cross-validated."""
    least_probability: float = 0.3
    """Least posterior probability, before recalibration, of a named effect of the most probable explanation."""
    folds: int = 5
    """Folds of the cross-validation over runs."""
    most_effects: int = 8
    """Most effects of a set that the search proposes; one at a time it may add more."""
    horizon: float = 0.5
    """Length of the open-loop predictions of the validation, s."""
    fit_horizon: float = 0.3
    """Length of the open-loop predictions through which the named effects are fitted together, s."""
    most_blocks: int = 200
    """Most blocks that are used of the fitting runs, drawn evenly; bounds the time of a diagnosis."""
    resamples: int = 400
    """Bootstrap resamples of the intervals."""

    def check(self) -> None:
        """Check the ranges of the settings.

        Raises:
            InputError: on a number that is out of its range.
        """
        check_positive(self, (*_LENGTHS, *_COUNT_KEYS), "gap")
        check_not_negative(self, ("margin", *_SHARES), "gap")
        for key in _SHARES:
            if getattr(self, key) > 1:
                raise InputError(f"must be at most 1, is {getattr(self, key)}", f"gap.{key}", "give a share")
        if self.folds < 2:
            raise InputError(f"must be at least 2, is {self.folds}", "gap.folds", "give 2 or more")
