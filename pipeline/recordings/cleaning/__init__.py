"""Cleaning: remove implausible values, fill short gaps, and report every change."""

from typing import TYPE_CHECKING

from simgap.lazy import imported_late
from simgap.recordings.cleaning.settings import Cleaning

if TYPE_CHECKING:
    from simgap.recordings.cleaning.account import summary
    from simgap.recordings.cleaning.clean import Cleaned, clean_recording, clean_with_coverage
    from simgap.recordings.cleaning.work import CHANGE_COLUMNS, COVERAGE_COLUMNS

__all__ = [
    "CHANGE_COLUMNS",
    "COVERAGE_COLUMNS",
    "Cleaned",
    "Cleaning",
    "clean_recording",
    "clean_with_coverage",
    "summary",
]

# Whoever needs the settings alone does not wait for SciPy.
__getattr__ = imported_late(
    __name__,
    account=("summary",),
    clean=("Cleaned", "clean_recording", "clean_with_coverage"),
    work=("CHANGE_COLUMNS", "COVERAGE_COLUMNS"),
)
