"""NumPy arrays and tensors: whatever comes in is computed with as tensors and goes out as it came."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import torch
from torch import Tensor

from simgap.errors import InputError


def to_tensor(value: Any, name: str) -> Tensor:
    """Return an array, a nested list or a tensor as a tensor of floating point numbers; whole numbers as float64.

    Raises:
        InputError: when it is none.
    """
    if isinstance(value, Tensor):
        return value if value.is_floating_point() else value.double()
    try:
        array = np.asarray(value)
        array = array if array.dtype in (np.float32, np.float64) else array.astype(np.float64)
    except (TypeError, ValueError) as error:
        remedy = "give an array of numbers or a tensor"
        raise InputError(f"is no array of numbers ({error})", name, remedy) from error
    return torch.tensor(array)


def like(result: Tensor, *given: Any) -> Any:
    """Return a tensor where one of what was given is a tensor, else an array."""
    return result if any(isinstance(value, Tensor) for value in given) else result.detach().numpy()


def alike(*tensors: Tensor) -> list[Tensor]:
    """Return tensors in the highest precision that one of them has, on the device of the first one."""
    dtype = tensors[0].dtype
    for tensor in tensors[1:]:
        dtype = torch.promote_types(dtype, tensor.dtype)
    return [tensor.to(tensors[0].device, dtype) for tensor in tensors]


def require_shape(tensor: Tensor, name: str, last: Sequence[str | int]) -> None:
    """Refuse a tensor whose last dimensions are not these; a text stands for any size.

    Raises:
        InputError: naming the shape that was expected and the one that was given.
    """
    shape = tuple(tensor.shape)
    trailing = shape[-len(last) :] if last else ()
    fits = len(shape) >= len(last) and all(
        isinstance(wanted, str) or wanted == found for wanted, found in zip(last, trailing, strict=True)
    )
    if not fits:
        expected = ", ".join(map(str, ("...", *last)))
        raise InputError(f"{name} must be ({expected}); got {shape}")


def require_one_batch(shapes: dict[str, torch.Size]) -> torch.Size:
    """Return the batch that shapes broadcast to.

    Args:
        shapes: of the leading dimensions, by the name of what has them.

    Raises:
        InputError: when they do not.
    """
    try:
        return torch.broadcast_shapes(*shapes.values())
    except RuntimeError:
        told = ", ".join(f"{name} {tuple(shape)}" for name, shape in shapes.items())
        raise InputError(f"the leading dimensions must broadcast: {told}") from None


def spread(tensor: Tensor, batch: torch.Size, last: int) -> Tensor:
    """Return a tensor (..., its last dimensions) for every machine of a batch, (machines, those dimensions)."""
    kept = tensor.shape[tensor.ndim - last :]
    return tensor.expand(*batch, *kept).reshape(batch.numel(), *kept)


def require_time_step(dt: float) -> float:
    """Return a time step as a number.

    Raises:
        InputError: when it is not a positive finite number of seconds.
    """
    seconds = float(dt)
    if not (math.isfinite(seconds) and seconds > 0):
        raise InputError(f"dt must be a positive number of seconds; got {dt!r}")
    return seconds
