"""A step over state and memory as rows of one tensor."""

from collections.abc import Callable
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor
from torch.utils import _pytree as tree

from simgap.errors import InputError

Function = Callable[
    [Float[Tensor, "batch n"], Float[Tensor, "batch k"], Any], tuple[Float[Tensor, "batch n"], Any]
]
"""From state (batch, n), action (batch, k) and memory to state and memory."""


class RowStep:
    """An eager step whose state and memory are rows (components, batch).

    So neighbours in memory are the same component of neighbouring machines. It keeps no gradients; use the function
    itself for those. Numbers that differ between machines may be part of the memory.
    """

    def __init__(self, function: Function, state: Tensor, memory: Any, repeats: int = 1) -> None:
        """Note the shapes of state and memory.

        Args:
            function: the step; each machine's result may depend on that machine alone.
            state: an example (batch, n), in the precision and on the device to run in.
            memory: what the function returned with a state: tensors, the batch leading.
            repeats: how often the step is taken in a call, with the action held.

        Raises:
            InputError: when the memory is something else.
        """
        leaves, self._tree = tree.tree_flatten(memory)
        if not all(isinstance(leaf, Tensor) and leaf.shape[:1] == state.shape[:1] for leaf in leaves):
            raise InputError(
                "is not all tensors with the batch leading", "memory", "run one eager step first"
            )
        self._shapes = [tuple(tensor.shape[1:]) for tensor in (state, *leaves)]
        self._repeats = repeats
        self._function = function

    @property
    def rows(self) -> int:
        """Numbers that one machine's state and memory are."""
        return sum(torch.Size(shape).numel() for shape in self._shapes)

    def pack(self, state: Float[Tensor, "batch n"], memory: Any) -> Float[Tensor, "components batch"]:
        """Return state and memory as rows (components, batch)."""
        tensors = [state, *tree.tree_leaves(memory)]
        return torch.cat([tensor.reshape(len(state), -1).T for tensor in tensors]).contiguous()

    def unpack(self, rows: Float[Tensor, "components batch"]) -> tuple[Float[Tensor, "batch n"], Any]:
        """Return the state (batch, n) and the memory that rows hold."""
        parts = rows.split([torch.Size(shape).numel() for shape in self._shapes])
        state, *leaves = (
            part.T.reshape(rows.shape[1], *shape) for part, shape in zip(parts, self._shapes, strict=True)
        )
        return state, tree.tree_unflatten(leaves, self._tree)

    @torch.no_grad()
    def __call__(
        self, rows: Float[Tensor, "components batch"], action: Float[Tensor, "k batch"]
    ) -> Float[Tensor, "components batch"]:
        """Return the rows after the step was taken `repeats` times.

        Args:
            rows: of `pack`.
            action: (k, batch).

        Raises:
            InputError: when a compiled step gets rows or an action that are not contiguous.
        """
        once = self._once(rows, action)
        for _ in range(self._repeats):
            rows = once(rows, action)
        return rows

    def _once(self, rows: Tensor, action: Tensor) -> Callable[[Tensor, Tensor], Tensor]:
        """Return what takes one step of such rows."""
        return self._eager

    def _eager(self, rows: Tensor, action: Tensor) -> Tensor:
        """Return the rows after one step, operation by operation."""
        state, memory = self.unpack(rows)
        return self.pack(*self._function(state, action.T, memory))
