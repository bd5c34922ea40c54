"""Floor 0: what was run, with what, and what came of it, in MLflow."""

from pipeline.tracking.config import Tracking
from pipeline.tracking.sweep import KeptTracker, SweepTracker
from pipeline.tracking.tracker import Tracker

__all__ = ["KeptTracker", "SweepTracker", "Tracker", "Tracking"]
