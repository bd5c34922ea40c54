"""Best checkpoint of a training, because the last policy is not always the best."""

import copy
import math
from collections.abc import Callable
from typing import Any

from torch import Tensor

from simgap.policies.networks import Gaussian

Judge = Callable[[Gaussian], float]
"""How much a policy costs; less is better, and NaN says that it is of no use."""


class Best:
    """The policy with the lowest cost so far; of two equal ones, the later.

    Attributes:
        cost: of it; infinite while none was of use.
    """

    def __init__(self, judge: Judge) -> None:
        self.cost = math.inf
        self._judge = judge
        self._weights: dict[str, Tensor] | None = None

    def consider(self, gaussian: Gaussian) -> None:
        """Keep a policy if it costs no more than the best so far."""
        cost = self._judge(gaussian)
        if cost <= self.cost:
            self.cost, self._weights = cost, copy.deepcopy(gaussian.state_dict())

    def restore(self, gaussian: Gaussian) -> None:
        """Make a policy the best again; where none was of use, it stays as it is."""
        if self._weights is not None:
            gaussian.load_state_dict(self._weights)

    def snapshot(self) -> dict[str, Any]:
        """Return what is kept, for a checkpoint."""
        return {"cost": self.cost, "weights": self._weights}

    def resume(self, snapshot: dict[str, Any]) -> None:
        """Go on where a snapshot was taken."""
        self.cost, self._weights = snapshot["cost"], snapshot["weights"]
