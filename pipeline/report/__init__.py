"""From artifacts to one page that a person reads."""

from pipeline.report.inputs import ReportInputs
from pipeline.report.page import write_page
from pipeline.report.section import Drawing

__all__ = ["Drawing", "ReportInputs", "write_page"]
