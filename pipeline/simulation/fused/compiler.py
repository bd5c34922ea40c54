"""The compiler that makes one loop of a step: used where there is one, done without where there is none."""

import sys
from collections.abc import Callable
from functools import cache
from typing import Any

import torch
import torch._inductor
from jaxtyping import Float
from torch import Tensor, fx
from torch.fx.experimental.proxy_tensor import make_fx

Step = Callable[
    [Float[Tensor, "components batch"], Float[Tensor, "k batch"]], Float[Tensor, "components batch"]
]
"""From state and memory (components, batch) and action (k, batch) to state and memory."""

_MANY = 2**16  # machines in the example from which the compiler decides whether threads share the work
_KEPT = 8  # steps that are kept compiled: more than one program flies at a time, and so few take no memory to speak of
_KNOWN: dict[tuple[Any, ...], "Step | None"] = {}


def compiled(
    graph: fx.GraphModule,
    rows: Float[Tensor, "components batch"],
    action: Float[Tensor, "k batch"],
    options: dict[str, Any],
) -> "Step | None":
    """Return a step as one loop over the batch; None, with one line on standard error, where nothing compiles here.

    A process compiles the same step once, however many environments fly by it.

    Args:
        graph: of the step, on components, with every constant written into it.
        rows: an example (components, batch).
        action: an example (k, batch).
        options: of TorchInductor.
    """
    inputs = [(len(tensor), tensor.dtype, tensor.device) for tensor in (rows, action)]
    key = (graph.code, *inputs, torch.get_num_threads(), *sorted(options.items()))
    if key not in _KNOWN:
        if len(_KNOWN) == _KEPT:
            del _KNOWN[next(iter(_KNOWN))]
        _KNOWN[key] = _newly_compiled(graph, rows, action, options)
    return _KNOWN[key]


def _newly_compiled(
    graph: fx.GraphModule, rows: Tensor, action: Tensor, options: dict[str, Any]
) -> "Step | None":
    from torch._inductor.exc import CppCompileError, InductorError, InvalidCxxCompiler

    examples = [tensor.new_empty(len(tensor), _MANY) for tensor in (rows, action)]
    traced = make_fx(graph, tracing_mode="symbolic")(*examples)
    symbolic = [node.meta["val"] for node in traced.graph.nodes if node.op == "placeholder"]
    try:
        return torch._inductor.compile(traced, symbolic, options=options)  # type: ignore[return-value]
    except InductorError as error:
        if isinstance(error.inner_exception, InvalidCxxCompiler):
            _say_once("no C++ compiler was found", "install g++, or name one in CXX")
        elif isinstance(error.inner_exception, CppCompileError):
            compiler = error.inner_exception.cmd[0]
            _say_once(f"{compiler} does not compile", "install g++ and the headers of Python and C")
        else:
            raise
        return None


@cache
def _say_once(reason: str, remedy: str) -> None:
    """Say once in a process what it costs; the factor is that of `train_policy branch=embedded` on one core."""
    print(
        f"warning: {reason}: simulated flights are not compiled, and training a policy takes twice as long; {remedy}",
        file=sys.stderr,
        flush=True,
    )
