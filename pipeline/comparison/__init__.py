"""Floor 0: what the jobs of a sweep have shown, side by side: tables, a figure, a page."""

from simgap.comparison.settings import Results

__all__ = ["Results"]
