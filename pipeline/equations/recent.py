"""What was worked out for a few sets of effects, kept while a fit asks for the same again."""

from collections import OrderedDict
from collections.abc import Callable, Sequence
from typing import Generic, TypeVar

from simgap.simulation import FittedEffect

Result = TypeVar("Result")


class Recent(Generic[Result]):
    """Results by effects and their values, the first ones forgotten first."""

    def __init__(self, most: int) -> None:
        """Begin with none; at most so many are kept."""
        self._most = most
        self._kept: OrderedDict[tuple[object, ...], Result] = OrderedDict()

    def of(self, effects: Sequence[FittedEffect], make: Callable[[], Result]) -> Result:
        """Return the result for some effects, made where it is not known."""
        key = tuple((fitted.effect, *fitted.values.values()) for fitted in effects)
        if key not in self._kept:
            self._kept[key] = make()
        if len(self._kept) > self._most:
            self._kept.popitem(last=False)
        return self._kept[key]
