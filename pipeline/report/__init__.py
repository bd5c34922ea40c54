"""From artifacts to one page that a person reads."""

from simgap.report.inputs import ReportInputs
from simgap.report.page import write_page
from simgap.report.section import Drawing

__all__ = ["Drawing", "ReportInputs", "write_page"]
