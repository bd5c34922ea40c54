"""Work on a GPU as one CUDA graph: sent in one go, where sending it kernel by kernel takes longer than the work."""

from collections.abc import Callable, Sequence
from functools import partial

import torch
from torch import Tensor

_PREPARING = 3
"""Calls that run as they are: libraries set themselves up, and an optimiser makes room for its state."""


class Captured:
    """Work that reads and writes tensors at fixed places, and asks nothing of the device.

    The first calls run as they are, and count; then the work is captured, and each call replays it. Without a GPU
    every call runs as it is.
    """

    def __init__(
        self, work: Callable[[], None], generators: Sequence[torch.Generator], device: torch.device
    ) -> None:
        """Note what is to be done.

        Args:
            work: without arguments and results.
            generators: from which it draws.
            device: on which it runs.
        """
        self._work, self._generators, self._device = work, generators, device
        self._calls = 0
        self._graph: torch.cuda.CUDAGraph | None = None

    def __call__(self) -> None:
        """Do the work once."""
        self._calls += 1
        if self._device.type != "cuda":
            self._work()
        elif self._calls <= _PREPARING:
            self._beside()
        else:
            self._graph = self._graph or self._captured()
            self._graph.replay()

    def _beside(self) -> None:
        """Run on a stream of its own, as a capture will."""
        stream = torch.cuda.Stream(self._device)
        stream.wait_stream(torch.cuda.current_stream(self._device))
        with torch.cuda.stream(stream):
            self._work()
        torch.cuda.current_stream(self._device).wait_stream(stream)

    def _captured(self) -> torch.cuda.CUDAGraph:
        graph = torch.cuda.CUDAGraph()
        for generator in self._generators:
            graph.register_generator_state(generator)
        with torch.cuda.graph(graph):
            self._work()
        return graph


class CapturedFunction:
    """A function of tensors that is one CUDA graph for each shape of what it is given.

    It works at fixed places: what it is given is copied there, and what it returns stays there until the next call.
    """

    def __init__(self, function: Callable[..., Tensor], device: torch.device) -> None:
        """Note what is to be done.

        Args:
            function: of tensors alone.
            device: on which it runs.
        """
        self._function, self._device = function, device
        self._placed: dict[tuple[torch.Size, ...], _Placed] = {}

    def __call__(self, *given: Tensor) -> Tensor:
        """Return the function's value."""
        shapes = tuple(tensor.shape for tensor in given)
        if shapes not in self._placed:
            self._placed[shapes] = _Placed(self._function, given, self._device)
        return self._placed[shapes](given)

    def forget(self) -> None:
        """Free what is kept for the shapes seen so far."""
        self._placed.clear()


class _Placed:
    """The function for tensors of one shape."""

    def __init__(
        self, function: Callable[..., Tensor], given: tuple[Tensor, ...], device: torch.device
    ) -> None:
        self._places = tuple(tensor.clone() for tensor in given)
        self._value: list[Tensor] = []
        self._captured = Captured(partial(_evaluate, function, self._places, self._value), (), device)

    def __call__(self, given: tuple[Tensor, ...]) -> Tensor:
        for place, tensor in zip(self._places, given, strict=True):
            place.copy_(tensor)
        self._captured()
        return self._value[0]


def _evaluate(function: Callable[..., Tensor], places: tuple[Tensor, ...], value: list[Tensor]) -> None:
    value[:] = [function(*places)]
