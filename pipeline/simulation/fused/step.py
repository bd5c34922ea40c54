"""A step as one compiled loop over the batch."""

from collections.abc import Callable
from typing import Any

import torch
from torch import Tensor
from torch.utils import _pytree as tree

from simgap.errors import InputError
from simgap.simulation.fused.compiler import compiled
from simgap.simulation.fused.rows import Function, RowStep
from simgap.simulation.fused.trace import component_graph

# The whole step is one kernel: splitting it gains nothing, and intermediate results would leave the registers.
_COMPILER_OPTIONS: dict[str, Any] = {"max_fusion_size": 1_000_000}
_ALONE: dict[str, Any] = _COMPILER_OPTIONS | {"cpp.threads": 1}
_WORTH_SHARING = 1024  # machines: fewer are done before a second thread has begun


class FusedStep(RowStep):
    """The same step as an eager function, in one pass over memory.

    The first call compiles the step, once for small and once for large batches; without a compiler the eager function
    runs.
    """

    def __init__(
        self, function: Function, state: Tensor, action: Tensor, memory: Any, repeats: int = 1
    ) -> None:
        """Write the step down for one machine.

        Args:
            function: the eager step; each machine's result may depend on that machine alone.
            state: an example (batch, n), in the precision and on the device to run in.
            action: an example (batch, k).
            memory: what the eager function returned with a state: tensors, the batch leading.
            repeats: how often the step is taken in a call, with the action held.

        Raises:
            InputError: when the step does what cannot be fused.
        """
        super().__init__(function, state, memory, repeats)
        leaves = tree.tree_leaves(memory)
        self._compiled: dict[bool, Callable[[Tensor, Tensor], Tensor]] = {}

        def flat(*tensors: Tensor) -> list[Tensor]:
            kept = tree.tree_unflatten(list(tensors[1:-1]), self._tree)
            after, remembered = function(tensors[0], tensors[-1], kept)
            return [after, *tree.tree_leaves(remembered)]

        # Constants are folded in double precision.
        groups = [[_one(tensor) for tensor in group] for group in ((state, *leaves), (action,))]
        self._graph = component_graph(flat, groups, state.dtype)

    @property
    def operations(self) -> int:
        """Operations of arithmetic in one compiled pass, each counted as one."""
        return sum(
            torch.Tag.pointwise in getattr(node.target, "tags", ()) for node in self._graph.graph.nodes
        )

    def _once(self, rows: Tensor, action: Tensor) -> Callable[[Tensor, Tensor], Tensor]:
        """Return the compiled step, which needs contiguous tensors, or the eager one without a compiler."""
        if not (rows.is_contiguous() and action.is_contiguous()):
            raise InputError("is not contiguous", "rows or action", "use pack and action.T.contiguous()")
        shared = rows.shape[1] >= _WORTH_SHARING
        if shared not in self._compiled:
            options = _COMPILER_OPTIONS if shared else _ALONE
            self._compiled[shared] = compiled(self._graph, rows, action, options) or self._eager
        return self._compiled[shared]


def _one(tensor: Tensor) -> Tensor:
    return tensor[:1].detach().cpu().double()
