"""What the machine could do at best: move the rows once, and do the arithmetic once."""

import time
from collections.abc import Callable

import torch
from torch import Tensor
from torch.fx.experimental.proxy_tensor import make_fx

_CHAINS, _LINKS = (
    8,
    64,
)  # independent, so that no operation waits for the one before; long, so that memory is idle


def copy_seconds(rows: int, batch: int, device: str) -> float:
    """Return how long it takes at best to read and write rows (rows, batch) of single precision, s."""
    source = torch.zeros(rows, batch, device=device)
    target = torch.empty_like(source)
    return _best(lambda: target.copy_(source), device)


def operations_per_second(device: str) -> float:
    """Return multiplications and additions in single precision per second, compiled as the simulator is."""
    values = torch.rand(_CHAINS, 2**16, device=device)

    def chained(values: Tensor) -> Tensor:
        return torch.stack([_chain(value) for value in values.unbind()])

    run = torch._inductor.compile(make_fx(chained)(values), [values])
    seconds = _best(lambda: run(values), device)
    return 2 * _LINKS * values.numel() / seconds


def _chain(value: Tensor) -> Tensor:
    for _ in range(_LINKS):
        value = value * 0.999 + 0.001
    return value


@torch.no_grad()
def _best(run: Callable[[], object], device: str, laps: int = 200) -> float:
    wait = torch.cuda.synchronize if device == "cuda" else lambda: None
    run()
    taken = []
    for _ in range(laps):
        wait()
        start = time.perf_counter()
        run()
        wait()
        taken.append(time.perf_counter() - start)
    return min(taken)
