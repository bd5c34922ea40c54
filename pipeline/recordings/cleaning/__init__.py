"""Cleaning: remove implausible values, fill short gaps, and report every change."""

from simgap.recordings.cleaning.account import summary
from simgap.recordings.cleaning.clean import Cleaned, clean_recording, clean_with_coverage
from simgap.recordings.cleaning.settings import Cleaning
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
