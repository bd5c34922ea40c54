"""Scalar form of a traced step: every entry of every small tensor becomes a series over the batch.

A step works on tensors (1, ...) of a few entries each: vectors, quaternions and matrices. Per entry its work is plain
arithmetic, and moving entries costs nothing. In this form a whole control step is one loop over the batch, and the
compiler keeps its values in registers.
"""

from collections.abc import Callable
from typing import Any

import torch
from torch import Tensor, fx
from torch._ops import OpOverload

from simgap.errors import InputError
from simgap.physics.shapes import Signal

Element = fx.Node | float | bool
"""One entry of a tensor: a series over the batch, or a number that all share."""

_aten = torch.ops.aten
_MOVES = {
    _aten.alias, _aten.broadcast_to, _aten.cat, _aten.clone, _aten.detach, _aten.diagonal, _aten.expand, _aten.flip,
    _aten.gather, _aten.index, _aten.index_select, _aten.lift_fresh, _aten.lift_fresh_copy, _aten.movedim,
    _aten.permute, _aten.repeat, _aten.reshape, _aten.roll, _aten.select, _aten.select_scatter, _aten.slice,
    _aten.slice_scatter, _aten.split, _aten.split_with_sizes, _aten.squeeze, _aten.stack, _aten.t, _aten.transpose,
    _aten.unbind, _aten.unsqueeze, _aten._unsafe_view, _aten.view,
}  # fmt: skip
_REDUCTIONS = {
    _aten.sum: _aten.add.Tensor,
    _aten.prod: _aten.mul.Tensor,
    _aten.amax: _aten.maximum.default,
    _aten.amin: _aten.minimum.default,
}
_MADE = {_aten.zeros_like, _aten.ones_like, _aten.full_like, _aten.new_zeros, _aten.new_ones, _aten.new_full}


class Components:
    """Writes the graph of one step over components.

    A tensor becomes a tensor of indices into `elements`, so torch itself moves its entries. A constant tensor stays a
    tensor of numbers, and torch computes with it directly.
    """

    def __init__(self, dtype: torch.dtype) -> None:
        self.graph = fx.Graph()
        self.dtype = dtype
        self.elements: list[Element] = []
        self._index: dict[tuple, int] = {}
        self._written: dict[tuple, Element] = {}

    def of(self, elements: list[Element], shape: tuple[int, ...]) -> "Entries":
        """Return the tensor of a shape that holds these elements."""
        return Entries(torch.tensor([self._place(e) for e in elements], dtype=torch.long).reshape(shape))

    def listed(self, value: "Entries | Signal") -> list[Element]:
        """Return the elements of a tensor, row by row."""
        return [self.elements[index] for index in self.entries(value).places.flatten().tolist()]

    def entries(self, value: "Entries | Signal") -> "Entries":
        """Return a tensor of numbers as one of elements."""
        if isinstance(value, Entries):
            return value
        return self.of(value.flatten().tolist(), tuple(value.shape))

    def run(self, target: OpOverload, args: tuple, kwargs: dict[str, Any], node: fx.Node) -> Any:
        """Return what an operation of the traced step makes of tensors of elements.

        Raises:
            InputError: when the operation mixes entries in a way that is not written here.
        """
        packet = target.overloadpacket
        if not _holds_entries((args, kwargs)):
            return target(*args, **kwargs)
        if packet in _MADE:
            return target(*_numbers(args), **kwargs)
        if packet in _MOVES:
            return self._moved(target, args, kwargs)
        if packet is _aten.copy:
            return Entries(self.entries(args[1]).places.expand(self.entries(args[0]).places.shape))
        if packet in _REDUCTIONS:
            return self._folded(_REDUCTIONS[packet], args[0], *args[1:], **_without_dtype(kwargs))
        if packet is _aten._to_copy:
            return self._converted(args[0], node)
        if torch.Tag.pointwise in target.tags:
            return self._pointwise(target, args, kwargs)
        raise InputError(
            f"{target} cannot be fused", "fused step", "use the eager step, or write the effect otherwise"
        )

    def _place(self, element: Element) -> int:
        key = (type(element), element)
        if key not in self._index:
            self._index[key] = len(self.elements)
            self.elements.append(element)
        return self._index[key]

    def _moved(self, target: OpOverload, args: tuple, kwargs: dict[str, Any]) -> Any:
        def places(value: Any) -> Any:
            if isinstance(value, Entries):
                return value.places
            return (
                self.entries(value).places
                if isinstance(value, Tensor) and value.dtype != torch.long
                else value
            )

        out = target(*_mapped(args, places), **_mapped(kwargs, places))
        return Entries(out) if isinstance(out, Tensor) else [Entries(part) for part in out]

    def _folded(
        self, combine: OpOverload, value: "Entries", dims: Any = None, keep: bool = False
    ) -> "Entries":
        places = value.places
        dims = range(places.ndim) if dims is None or dims == [] else [dims] if isinstance(dims, int) else dims
        for dim in sorted((dim % places.ndim for dim in dims), reverse=True):
            first, *others = (Entries(part) for part in places.unbind(dim))
            for other in others:
                first = self._pointwise(combine, (first, other), {})
            places = first.places.unsqueeze(dim) if keep else first.places
        return Entries(places)

    def _converted(self, value: "Entries", node: fx.Node) -> "Entries":
        made = node.meta["val"].dtype
        source = node.args[0]
        if made.is_floating_point and isinstance(source, fx.Node) and source.meta["val"].dtype == torch.bool:
            one, zero = torch.tensor(1.0), torch.tensor(0.0)
            return self._pointwise(_aten.where.self, (value, one, zero), {})
        return value

    def _pointwise(self, target: OpOverload, args: tuple, kwargs: dict[str, Any]) -> "Entries":
        tensors = [index for index, a in enumerate(args) if isinstance(a, Entries | Tensor)]
        places = torch.broadcast_tensors(*(self.entries(args[index]).places for index in tensors))
        made = []
        for chosen in zip(*(place.flatten().tolist() for place in places), strict=True):
            full = list(args)
            for index, place in zip(tensors, chosen, strict=True):
                full[index] = self.elements[place]
            made.append(self._write(target, full, kwargs))
        return self.of(made, tuple(places[0].shape))

    def _write(self, target: OpOverload, args: list, kwargs: dict[str, Any]) -> Element:
        if not any(isinstance(a, fx.Node) for a in args):
            return _computed(target, args, kwargs)
        simple = None if kwargs or len(args) != 2 else _simplified(target.overloadpacket, *args)
        if isinstance(simple, tuple):
            return self._write(simple[0], list(simple[1:]), {})
        if simple is not None:
            return simple
        key = (target, *((type(a), a) for a in args), *sorted(kwargs.items()))
        if key not in self._written:
            self._written[key] = self.graph.call_function(target, self._wrapped(target, args), kwargs)
        return self._written[key]

    def _wrapped(self, target: OpOverload, args: list) -> tuple:
        """Make tensors of the numbers where the operation takes none."""
        wants = [str(argument.type) == "Tensor" for argument in target._schema.arguments]
        return tuple(
            self._number(a) if wanted and not isinstance(a, fx.Node) else a
            for a, wanted in zip(args, wants, strict=False)
        )

    def _number(self, number: float | bool) -> fx.Node:
        key = ("number", type(number), number)
        if key not in self._written:
            dtype = torch.bool if isinstance(number, bool) else self.dtype
            self._written[key] = self.graph.call_function(
                _aten.scalar_tensor.default, (number,), {"dtype": dtype}
            )
        made = self._written[key]
        assert isinstance(made, fx.Node)
        return made


class Entries:
    """A tensor whose entries are places in a list of elements.

    Attributes:
        places: integers, of the tensor's shape.
    """

    def __init__(self, places: Tensor) -> None:
        self.places = places


def _holds_entries(value: Any) -> bool:
    if isinstance(value, dict):
        return _holds_entries(list(value.values()))
    if isinstance(value, list | tuple):
        return any(_holds_entries(part) for part in value)
    return isinstance(value, Entries)


def _numbers(args: tuple) -> tuple:
    def stand_in(value: Any) -> Any:
        return torch.zeros(value.places.shape, dtype=torch.float64) if isinstance(value, Entries) else value

    return _mapped(args, stand_in)


def _mapped(values: Any, change: Callable[[Any], Any]) -> Any:
    if isinstance(values, tuple | list):
        return type(values)([_mapped(value, change) for value in values])
    if isinstance(values, dict):
        return {name: _mapped(value, change) for name, value in values.items()}
    return change(values)


def _without_dtype(kwargs: dict[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in kwargs.items() if name != "dtype"}


def _computed(target: OpOverload, args: list, kwargs: dict[str, Any]) -> float | bool:
    numbers = [torch.tensor(a, dtype=torch.float64) if isinstance(a, float) else a for a in args]
    numbers = [torch.tensor(a) if isinstance(a, bool) else a for a in numbers]
    return target(*numbers, **kwargs).item()


def _simplified(packet: Any, left: Any, right: Any) -> Element | tuple | None:
    """Return a number, an element or a cheaper operation in the place of one on a number; None where there is none."""
    if packet is _aten.mul and (_is(left, 0.0) or _is(right, 0.0)):
        return 0.0
    if packet is _aten.mul and (_is(left, 1.0) or _is(right, 1.0)):
        return right if _is(left, 1.0) else left
    if packet is _aten.add and (_is(left, 0.0) or _is(right, 0.0)):
        return right if _is(left, 0.0) else left
    if packet is _aten.sub and (_is(left, 0.0) or _is(right, 0.0)):
        return (_aten.neg.default, right) if _is(left, 0.0) else left
    if packet is _aten.div and isinstance(right, int | float) and right != 0:
        return (_aten.mul.Tensor, left, 1.0 / right)
    if packet is _aten.pow and (_is(right, 0.0) or _is(right, 1.0)):
        return 1.0 if _is(right, 0.0) else left
    return None


def _is(element: Any, number: float) -> bool:
    return isinstance(element, int | float) and element == number
