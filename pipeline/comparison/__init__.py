"""Floor 0: comparison of the jobs of a sweep: tables, a figure, a page."""

from simgap.comparison.settings import Results

__all__ = ["Results"]
