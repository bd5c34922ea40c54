"""Tracing, and when a compiled loop over numbers may take the place of operations on tensors."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

import torch
from jaxtyping import Float
from torch import Tensor

_TRACED: ContextVar[bool] = ContextVar("traced", default=False)


def may_run_compiled(series: tuple[Float[Tensor, "..."], ...], values: tuple[Any, ...] = ()) -> bool:
    """Whether nobody asks for more than the numbers.

    Args:
        series: tensors of any shape that the loop reads; they have to be on the processor and ask for no gradients.
        values: parameters, which have to be numbers.

    Returns:
        False too while operations are traced or compiled: a loop over numbers would leave no operation behind.
    """
    if _TRACED.get() or torch.compiler.is_compiling() or any(isinstance(value, Tensor) for value in values):
        return False
    return not any(each.requires_grad or each.device.type != "cpu" for each in series)


@contextmanager
def traced_operations() -> Iterator[None]:
    """Have everything within computed by operations on tensors, which a tracer can record."""
    before = _TRACED.set(True)
    try:
        yield
    finally:
        _TRACED.reset(before)
