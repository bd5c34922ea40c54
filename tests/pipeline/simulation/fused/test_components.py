"""What a function does to small tensors, its component graph does to rows."""

from collections.abc import Callable

import pytest
import torch
from torch import Tensor

from simgap.errors import InputError
from simgap.physics import rotations
from simgap.simulation.fused.trace import component_graph

BATCH = 7


def in_place(a: Tensor, b: Tensor) -> list[Tensor]:
    out = torch.zeros_like(a)
    out[..., 2] = -9.81
    out[..., 0] = b[..., 1]
    return [out + a]


FUNCTIONS: dict[str, Callable[[Tensor, Tensor], list[Tensor]]] = {
    "arithmetic": lambda a, b: [a * b - 0.5 * a / (1.0 + b.square()), 2.0 - a, -b, a / 4.0],
    "numbers": lambda a, b: [a * 0.0, a + 0.0, 0.0 - b, a * 1.0, a**0, a**1, a**3, torch.ones_like(a)],
    "functions": lambda a, b: [torch.exp(-a.abs()), b.abs().sqrt(), torch.tanh(a), torch.atan2(a, b)],
    "choices": lambda a, b: [torch.where(a > b, a, torch.zeros_like(a)), a.maximum(b), b.clamp(-0.2, 0.3)],
    "masks": lambda a, b: [((a > 0) & (b > 0)).to(a) * a, (a < 0.1).to(a)],
    "moves": lambda a, b: [torch.cat([a[..., 1:], b[..., None, 0]], -1), torch.stack([a, b], -1).transpose(-1, -2)],
    "folds": lambda a, b: [a.sum(-1), a.amax(-1, keepdim=True), a.prod(-1), b.mean(-1), b.amin(-1), a.norm(dim=-1)],
    "vectors": lambda a, b: [rotations.cross(a, b), rotations.rotate(rotations.from_rotation_vector(a), b)],
    "products": lambda a, b: [a @ torch.arange(9.0).double().reshape(3, 3), (a[..., None] @ b[..., None, :])],
    "inverses": lambda a, b: [torch.linalg.inv(a[..., None] * b[..., None, :] + 3.0 * torch.eye(3).to(a))],
    "constants": lambda a, b: [a * torch.tensor([1.0, 2.0, 0.0]).to(a), a.new_full((1, 3), 2.0) + b],
    "in place": in_place,
}  # fmt: skip


@pytest.mark.parametrize("name", FUNCTIONS)
def test_the_graph_computes_what_the_function_computes(name):
    function = FUNCTIONS[name]
    a, b = torch.randn(2, BATCH, 3, dtype=torch.float64, generator=torch.Generator().manual_seed(0))
    graph = component_graph(lambda *both: function(*both), [[a[:1]], [b[:1]]], torch.float64)
    expected = torch.cat([out.expand(BATCH, *out.shape[1:]).reshape(BATCH, -1).T for out in function(a, b)])
    torch.testing.assert_close(graph(a.T, b.T), expected, rtol=1e-13, atol=1e-13)


def test_what_is_zero_for_all_costs_nothing():
    def some(a: Tensor) -> list[Tensor]:
        return [a + (a * torch.tensor([0.0, 1.0, 0.0]).to(a)).sum(-1, keepdim=True)]

    graph = component_graph(some, [[torch.ones(1, 3, dtype=torch.float64)]], torch.float64)
    operations = [node.target for node in graph.graph.nodes if node.op == "call_function"]
    assert operations.count(torch.ops.aten.add.Tensor) == 3
    assert torch.ops.aten.mul.Tensor not in operations


@pytest.mark.parametrize(
    "function",
    [lambda a: [a.sort(-1).values], lambda a: [a if float(a.sum()) > 0 else -a], lambda a: [a.cumsum(-1)]],
    ids=["sorts", "branches", "accumulates"],
)
def test_what_cannot_be_fused_is_refused(function):
    with pytest.raises(InputError, match="eager"):
        component_graph(function, [[torch.ones(1, 3, dtype=torch.float64)]], torch.float64)
