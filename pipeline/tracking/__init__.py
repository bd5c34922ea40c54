"""Floor 0: what was run, with what, and what came of it, in MLflow."""

from simgap.tracking.config import Tracking
from simgap.tracking.sweep import KeptTracker, SweepTracker
from simgap.tracking.tracker import Tracker

__all__ = ["KeptTracker", "SweepTracker", "Tracker", "Tracking"]
