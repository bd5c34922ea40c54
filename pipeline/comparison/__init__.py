"""Floor 0: the metrics of a sweep's jobs side by side, as tables, a figure and a page."""

from simgap.comparison.settings import Results

__all__ = ["Results"]
