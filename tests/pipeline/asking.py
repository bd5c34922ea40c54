"""What may not stand in a CUDA graph."""

from typing import Any

import torch
from torch.utils._python_dispatch import TorchDispatchMode

aten = torch.ops.aten


class Asking(TorchDispatchMode):
    """Refuses what waits for a device, or brings numbers to it."""

    def __torch_dispatch__(self, func: Any, types: Any, args: Any = (), kwargs: Any = None) -> Any:
        masks = func is aten.index.Tensor and any(i is not None and i.dtype == torch.bool for i in args[1])
        waiting = (aten.nonzero.default, aten._local_scalar_dense.default, aten.lift_fresh.default)
        assert not masks, "a mask asks how many it chooses"
        assert func not in waiting, f"{func} asks something of the device"
        return func(*args, **(kwargs or {}))
