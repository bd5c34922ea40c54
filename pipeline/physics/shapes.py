"""Shapes of tensors by name, which the test suite checks at every call.

`*#batch` is any number of leading dimensions that broadcast with those of the other arguments of a function.
"""

from collections.abc import Mapping

from jaxtyping import Float
from torch import Tensor

Real = Float[Tensor, "*#batch"]
Pair = Float[Tensor, "*#batch 2"]
Vector = Float[Tensor, "*#batch 3"]
Quaternion = Float[Tensor, "*#batch 4"]
Matrix = Float[Tensor, "*#batch 3 3"]
PerModule = Float[Tensor, "*#batch 4"]
"""One number for each of four rotors, wheels or modules."""

Value = float | Real
"""A number of a law, or one for each machine of a batch."""

State = Float[Tensor, "*batch components"]
Series = Float[Tensor, "blocks samples *rest"]
"""A signal along the samples of blocks of a recording."""

Signal = Float[Tensor, "..."]
Signals = Mapping[str, Signal]
"""Physical signals by name: `velocity` (..., 3), `rotor_speed` (..., 4), `voltage` (...,) and so on."""

Channels = dict[str, Real]
"""What acts on each channel of a platform's balance, by name, (...,) in that channel's unit."""
