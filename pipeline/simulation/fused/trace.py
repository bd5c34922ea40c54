"""Tracing of a step, and its rewriting in scalar components."""

import itertools
from collections.abc import Callable
from typing import Any

import torch
from torch import Tensor, fx
from torch.func import functionalize
from torch.fx.experimental.proxy_tensor import make_fx

from simgap.errors import InputError
from simgap.physics.shapes import Signal
from simgap.physics.tracing import traced_operations
from simgap.simulation.fused.components import Components, Entries

_aten = torch.ops.aten


def component_graph(
    function: Callable[..., list[Signal]], examples: list[list[Signal]], dtype: torch.dtype
) -> fx.GraphModule:
    """Return a module that applies a function of batch-one tensors to components over the batch.

    Args:
        function: takes all tensors of all groups in order, returns tensors.
        examples: groups of tensors (1, ...), float64.
        dtype: in which the module will run.

    Returns:
        A module from one tensor (components, batch) per group to one tensor (components, batch).

    Raises:
        InputError: when the function does what cannot be written so.
    """
    try:
        with traced_operations():
            traced = make_fx(functionalize(function), decomposition_table=_SIMPLER)(
                *itertools.chain(*examples)
            )
    except RuntimeError as error:
        remedy = "use the eager step; nothing may depend on the numbers in a batch but by arithmetic"
        raise InputError(f"cannot be written down: {error}", "fused step", remedy) from error
    components = Components(dtype)
    inputs = iter([entry for group in examples for entry in _inputs(components, group)])
    known: dict[fx.Node, Any] = {}
    for node in traced.graph.nodes:
        args, kwargs = (fx.node.map_arg(part, known.__getitem__) for part in (node.args, node.kwargs))
        if node.op == "placeholder":
            known[node] = next(inputs)
        elif node.op == "get_attr":
            known[node] = getattr(traced, node.target).detach().clone()
        elif node.op == "call_function":
            known[node] = _run(components, node, args, kwargs)
        else:
            _finish(components, args[0])
    return fx.GraphModule(torch.nn.Module(), components.graph)


def _run(components: Components, node: fx.Node, args: Any, kwargs: Any) -> Any:
    if isinstance(node.target, torch._ops.OpOverload):
        return components.run(node.target, args, kwargs, node)
    return node.target(*args, **kwargs)  # type: ignore[operator]


def _inputs(components: Components, group: list[Tensor]) -> list[Entries]:
    rows = components.graph.placeholder(f"rows{len(components.graph.nodes)}")
    taken, entries = 0, []
    for tensor in group:
        series = [
            components.graph.call_function(_aten.select.int, (rows, 0, taken + index))
            for index in range(tensor.numel())
        ]
        entries.append(components.of(list(series), tuple(tensor.shape)))
        taken += tensor.numel()
    return entries


def _finish(components: Components, outputs: Any) -> None:
    elements = [element for value in outputs for element in components.listed(value)]
    like = next(element for element in elements if isinstance(element, fx.Node))
    series = [
        element
        if isinstance(element, fx.Node)
        else components.graph.call_function(_aten.full_like.default, (like, element))
        for element in elements
    ]
    components.graph.output(components.graph.call_function(_aten.stack.default, (series,)))
    components.graph.eliminate_dead_code()


def _cross(left: Tensor, right: Tensor, *, dim: int = -1) -> Tensor:
    (a, b, c), (d, e, f) = left.unbind(dim), right.unbind(dim)
    return torch.stack([b * f - c * e, c * d - a * f, a * e - b * d], dim)


def _norm(
    value: Tensor, order: Any = 2, dim: Any = None, keepdim: bool = False, *, dtype: Any = None
) -> Tensor:
    if order != 2:
        raise RuntimeError("a norm other than the Euclidean")
    return value.square().sum(dim, keepdim).sqrt()


def _mean(value: Tensor, dim: Any = None, keepdim: bool = False, *, dtype: Any = None) -> Tensor:
    total = value.sum(dim, keepdim)
    return total * (total.numel() / value.numel())


def _product(left: Tensor, right: Tensor) -> Tensor:
    return (left.unsqueeze(-1) * right.unsqueeze(-3)).sum(-2)


def _inverse(matrix: Tensor, *, check_errors: bool = False) -> tuple[Tensor, Tensor]:
    if matrix.shape[-1] != 3:
        raise RuntimeError("an inverse of other than 3 x 3")
    a, b, c = matrix.unbind(-2)
    columns = torch.stack([_cross(b, c), _cross(c, a), _cross(a, b)], -1)
    determinant = (a * columns[..., 0]).sum(-1)
    return columns / determinant[..., None, None], torch.zeros_like(determinant, dtype=torch.int32)


_SIMPLER: dict[Any, Callable[..., Any]] = {
    _aten.linalg_cross.default: _cross,
    _aten.linalg_inv_ex.default: _inverse,
    _aten.linalg_vector_norm.default: _norm,
    _aten.mean.dim: _mean,
    _aten.mean.default: _mean,
    _aten.mm.default: _product,
    _aten.bmm.default: _product,
    _aten.square.default: lambda value: value * value,
}
