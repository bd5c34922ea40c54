"""One self-contained page: sections, style and script in a single file that needs no network."""

import base64
import hashlib
import re
from importlib import resources
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from simgap.errors import InputError
from simgap.report import text
from simgap.report.cleaning import cleaning_section
from simgap.report.driven import driven_section
from simgap.report.figure import script_json
from simgap.report.fit import fit_section
from simgap.report.flown import flown_section
from simgap.report.identified import parameters_section
from simgap.report.inputs import ReportInputs
from simgap.report.laws import laws_section
from simgap.report.models import model_section, sweeps_section
from simgap.report.provenance import provenance_section, warnings_section
from simgap.report.section import Drawing, Section
from simgap.report.sure import sure_section
from simgap.report.tables import cell
from simgap.report.traces import traces_section
from simgap.report.use import use_section
from simgap.report.verdict import verdict_section
from simgap.report.what import what_section
from simgap.report.where import where_section

_SECTIONS = (
    verdict_section,
    what_section,
    sure_section,
    where_section,
    fit_section,
    traces_section,
    laws_section,
    cleaning_section,
    parameters_section,
    model_section,
    sweeps_section,
    flown_section,
    driven_section,
    warnings_section,
    provenance_section,
    use_section,
)
_WITH_CONTRADICTION = (
    "verdict",
    "traces",
    "cleaning",
    "warnings",
    "provenance",
    "use",
)  # the rest rests on names
_FILTERS = (
    text.number,
    text.short,
    text.estimate,
    text.with_unit,
    text.pretty_unit,
    text.quantity,
    text.percent,
    text.probability,
    text.p_value,
    text.interval,
    text.spoken,
    text.listed,
    text.breakable,
    script_json,
    cell,
)


def write_page(inputs: ReportInputs, target: Path, drawing: Drawing | None = None) -> None:
    """Write the report of a pipeline run as one HTML file; the same artifacts give the same bytes.

    Args:
        inputs: the artifacts; a section whose artifact is absent is left out.
        target: the file to write.
        drawing: how much of the evidence is drawn.

    Raises:
        InputError: where there is nothing to report, or an artifact cannot be read.
    """
    built = (build(inputs, drawing or Drawing()) for build in _SECTIONS)
    contradicted = (inputs.diagnosis or {}).get("verdict") == "contradiction"
    sections = [
        section
        for section in built
        if section is not None and (not contradicted or section.key in _WITH_CONTRADICTION)
    ]
    if all(section.key == "provenance" for section in sections):
        raise InputError(
            "there are no artifacts to report", inputs.name or "report", "run the stages before it"
        )
    target.write_bytes(_render(inputs.name, sections).encode("utf-8", "replace"))


def _render(name: str, sections: list[Section]) -> str:
    environment = Environment(
        loader=PackageLoader("simgap.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=_with_minus,
    )
    environment.filters |= {function.__name__: function for function in _FILTERS}
    scripts = [_script(_asset("chart.js")), _script(_asset("page.js"))]
    return environment.get_template("page.html").render(
        name=name,
        sections=sections,
        style=Markup(_asset("page.css")),
        scripts=[Markup(script) for script in scripts],
        policy=_policy(scripts),
    )


def _with_minus(value: object) -> object:
    """Return text with the one minus sign of the page; markup, and what is no text, as it is."""
    return text.minus(value) if isinstance(value, str) and not isinstance(value, Markup) else value


def _asset(file: str) -> str:
    return resources.files("simgap.report").joinpath("templates", file).read_text("utf-8")


def _script(source: str) -> str:
    """Return a script that survives inside HTML as it is, so that its hash holds."""
    source = source.replace("\r\n", "\n").replace("\r", "\n")
    return re.sub(r"<(?=/script|!--)", r"\\x3c", source, flags=re.IGNORECASE)


def _policy(scripts: list[str]) -> str:
    """Return a content security policy: these scripts alone may run, and nothing may be fetched."""
    digests = (base64.b64encode(hashlib.sha256(script.encode()).digest()).decode() for script in scripts)
    allowed = " ".join(f"'sha256-{digest}'" for digest in digests)
    return (
        f"default-src 'none'; script-src {allowed}; style-src 'unsafe-inline'; img-src data: blob:; "
        "base-uri 'none'; form-action 'none'"
    )
