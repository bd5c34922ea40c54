"""Arithmetic on many pixels, which a GPU does in one pass over memory instead of one for every operation."""

from collections.abc import Callable
from functools import cache
from typing import ParamSpec, TypeVar

import torch

Given = ParamSpec("Given")
Result = TypeVar("Result")


def fused(function: Callable[Given, Result], device: torch.device) -> Callable[Given, Result]:
    """Return a function compiled where it runs on a GPU, and as it is where it runs on a CPU.

    A compiler for CPUs is not always at hand. What is compiled agrees with what is not to rounding.
    """
    return _compiled(function) if device.type == "cuda" else function


@cache
def _compiled(function: Callable[Given, Result]) -> Callable[Given, Result]:
    return torch.compile(function)
