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
    """The policies that cost less than all before them; of two equal ones, the later. The last of them is the best."""

    def __init__(self, judge: Judge) -> None:
        self._judge = judge
        self._kept: list[tuple[float, dict[str, Tensor]]] = []

    @property
    def costs(self) -> list[float]:
        """Of the policies, each lower than the one before."""
        return [cost for cost, _ in self._kept]

    def consider(self, gaussian: Gaussian) -> None:
        """Keep a policy if it costs no more than the best so far."""
        cost, least = self._judge(gaussian), self._kept[-1][0] if self._kept else math.inf
        if not cost <= least:
            return
        if cost == least and self._kept:
            self._kept.pop()
        self._kept.append((cost, copy.deepcopy(gaussian.state_dict())))

    def restore(self, gaussian: Gaussian, number: int = -1) -> None:
        """Make a policy one of those in `costs`, or the best; where none was of use, it stays as it is."""
        if self._kept:
            gaussian.load_state_dict(self._kept[number][1])

    def snapshot(self) -> dict[str, Any]:
        """Return what is kept, for a checkpoint."""
        return {"kept": list(self._kept)}

    def resume(self, snapshot: dict[str, Any]) -> None:
        """Go on where a snapshot was taken."""
        self._kept = list(snapshot["kept"])
