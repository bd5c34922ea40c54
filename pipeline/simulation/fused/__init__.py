"""The fast path: a step of simulation compiled into one loop over the batch."""

from pipeline.simulation.fused.step import FusedStep

__all__ = ["FusedStep"]
