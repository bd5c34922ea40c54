"""The answer of a diagnosis: what was found, the simulators, and what can be written of it."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simgap.api.findings import Ambiguity, Contradiction, Effect, Fit, Mismatch, Unnamed, built
from simgap.errors import InputError

if TYPE_CHECKING:
    from simgap.api.flow import Found
    from simgap.api.machine import Machine
    from simgap.simulation import Simulator


@dataclass(frozen=True, kw_only=True)
class Answer:
    """What `simgap.diagnose` found. A notebook shows it as a table.

    Attributes:
        verdict: `missing_physics`, `parameter_mismatch`, `none`, `unexplained` or `contradiction`.
        effects: what is believed present, most probable first.
        ambiguous: effects that are not told apart.
        unnamed: what no effect accounts for.
        mismatch: where the nominal simulator fails.
        fit: errors before and after, on held-out runs.
        warnings: doubts about the recording and the result, one sentence each.
        contradictions: why nothing could be named, with the verdict `contradiction`.
    """

    verdict: str
    effects: tuple[Effect, ...]
    ambiguous: tuple[Ambiguity, ...]
    unnamed: tuple[Unnamed, ...]
    mismatch: tuple[Mismatch, ...]
    fit: Fit
    warnings: tuple[str, ...]
    contradictions: tuple[Contradiction, ...] = ()
    _found: "Found" = field(repr=False, compare=False)
    _name: str = field(repr=False, compare=False)

    @classmethod
    def of(cls, found: "Found", name: str) -> "Answer":
        """Return the answer that a diagnosis gives.

        Args:
            found: the diagnosis.
            name: of the recording, for the heading of its page.
        """
        return built(cls, {**found.document, "_found": found, "_name": name})

    @property
    def document(self) -> dict[str, Any]:
        """The same as plain numbers, texts and lists: what `diagnosis.json` holds (docs/contract.md)."""
        return self._found.document

    @property
    def simulator(self) -> "Machine":
        """The simulator with the effects that were named, driven by what was recorded."""
        return self._machine(self._found.diagnosis.simulator)

    @property
    def nominal(self) -> "Machine":
        """The simulator before the diagnosis, driven by what was recorded."""
        return self._machine(self._found.diagnosis.nominal)

    def _machine(self, simulator: "Simulator") -> "Machine":
        from simgap.api.layout import recorded_command
        from simgap.api.machine import Machine

        recorded = self._found.diagnosis.fitting.blocks.signals
        return Machine(simulator, recorded_command(simulator.platform.kind, recorded))

    def save(self, folder: str | Path) -> Path:
        """Write what `simgap diagnose` writes: `diagnosis.json`, `report.html`, `simulator/` and the evidence.

        The folder is whole or not there; other files that are in it stay.

        Args:
            folder: to write; it is made if needed.

        Returns:
            The folder.

        Raises:
            InputError: when the place cannot be written.
        """
        from simgap.api.flow import write_report
        from simgap.artifacts import staged_directory

        target = Path(folder).expanduser()
        with staged_directory(target) as staged:
            self._found.write(staged)
            write_report(staged, staged / "report.html", self._name, f"{target}/simulator")
        return target

    def report(self, path: str | Path) -> Path:
        """Write the page that explains the answer, one HTML file that needs no network.

        Args:
            path: of the file; a file that is there is replaced.

        Returns:
            The path.

        Raises:
            InputError: when the place cannot be written.
        """
        import tempfile

        from simgap.api.flow import write_report

        target = Path(path).expanduser()
        with tempfile.TemporaryDirectory() as temporary:
            self._found.write(Path(temporary))
            page = Path(temporary) / "report.html"
            write_report(Path(temporary), page, self._name, "answer/simulator")
            _replace(target, page.read_bytes())
        return target

    def __repr__(self) -> str:
        from simgap.api.display import text

        return text(self.document)

    def _repr_html_(self) -> str:
        from simgap.api.display import html

        return html(self.document)


def _replace(target: Path, content: bytes) -> None:
    """Write a file that is whole or not there."""
    partial = target.with_name(f".partial-{target.name}")
    try:
        partial.write_bytes(content)
        partial.replace(target)
    except OSError as error:
        partial.unlink(missing_ok=True)
        raise InputError(
            f"cannot be written ({error.strerror})", str(target), "choose another place"
        ) from error
