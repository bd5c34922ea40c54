"""Checked reading of tensors by name and shape."""

from collections.abc import Mapping, Sequence

from torch import Tensor

from simgap.errors import InputError


def take_tensors(tensors: Mapping[str, Tensor], shapes: Mapping[str, Sequence[int]]) -> dict[str, Tensor]:
    """Return the tensors of these names and shapes.

    Raises:
        InputError: when one is missing, of another shape or not finite, or there is another one.
    """
    if set(tensors) != set(shapes):
        names = sorted(set(tensors) ^ set(shapes))
        raise InputError(f"unexpected or missing tensor {names[0]!r}", "model", "train the model again")
    for name, shape in shapes.items():
        tensor = tensors[name]
        if tuple(tensor.shape) != tuple(shape):
            found = f"tensor {name!r} has shape {tuple(tensor.shape)}, not {tuple(shape)}"
            raise InputError(found, "model", "train the model again")
        if tensor.is_floating_point() and not tensor.isfinite().all():
            raise InputError(f"tensor {name!r} is not finite", "model", "train the model again")
    return dict(tensors)
