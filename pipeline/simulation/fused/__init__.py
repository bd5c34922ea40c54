"""The fast path: a step of simulation compiled into one loop over the batch."""

from simgap.simulation.fused.rows import RowStep
from simgap.simulation.fused.step import FusedStep

__all__ = ["FusedStep", "RowStep"]
