"""Identified nominal parameters, where that stage ran."""

from simgap.report.inputs import ReportInputs, read_json, read_yaml
from simgap.report.section import Drawing, Section
from simgap.report.tables import metric_tables, parameter_rows


def parameters_section(inputs: ReportInputs, drawing: Drawing) -> Section | None:
    """List the identified parameters with their standard errors, and how well they fit."""
    parameters = read_yaml(inputs.sysid, "parameters.yaml")
    metrics = read_json(inputs.sysid, "metrics.json")
    if not parameters and not metrics:
        return None
    content = {"parameters": parameter_rows(parameters or {}), "tables": metric_tables(metrics or {})}
    return Section("parameters", "Identified parameters", content)
