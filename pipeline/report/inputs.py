"""What a report is made from: folders of artifacts, any of which may be absent."""

import json
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd
import pyarrow
import pyarrow.parquet as parquet
import yaml

from simgap.errors import InputError

_STAGES = (
    "diagnose",
    "clean",
    "sysid",
    "train",
    "evaluate",
    "profile",
    "deploy",
    "identify_residual",
    "redeploy",
)


@dataclass(frozen=True)
class ReportInputs:
    """The artifacts of one pipeline run, or of one `simgap diagnose`.

    Attributes:
        diagnose: folder of `diagnosis.json` and `evidence/`.
        clean: folder of `changes.parquet`, `coverage.parquet`, `recording.parquet`.
        sysid: folder of `parameters.yaml`, `metrics.json`.
        train: folder of `metrics.json`, `residuals.svg`.
        evaluate: folder of `metrics.json`, `line.png`, `flight.gif`.
        profile: folder of `metrics.json`, `motions.svg`, of planned motions.
        deploy: folder of `metrics.json`, of flights or trials on the machine.
        identify_residual: folder of `realisations.png`.
        redeploy: as deploy, of the policy that was trained further.
        sweeps: folders of `comparison.json`.
        name: of the configuration, or of the file that was diagnosed.
        simulator: path of the simulator with the named effects, as a person types it.
    """

    diagnose: Path | None = None
    clean: Path | None = None
    sysid: Path | None = None
    train: Path | None = None
    evaluate: Path | None = None
    profile: Path | None = None
    deploy: Path | None = None
    identify_residual: Path | None = None
    redeploy: Path | None = None
    sweeps: tuple[Path, ...] = ()
    name: str = ""
    simulator: str = "simulator"

    @classmethod
    def of_branch(cls, artifacts: Path, name: str = "", simulator: str = "simulator") -> "ReportInputs":
        """Take every stage's folder below `artifacts`; those that are not there are left out."""
        folders = {stage: artifacts / stage if (artifacts / stage).is_dir() else None for stage in _STAGES}
        sweeps = sorted(path.parent for path in artifacts.glob("sweeps/*/*/comparison.json"))
        return cls(**folders, sweeps=tuple(sweeps), name=name, simulator=simulator)

    @property
    def folders(self) -> list[Path]:
        """The folders that are there."""
        folders = [*(getattr(self, stage) for stage in _STAGES), *self.sweeps]
        return [folder for folder in folders if folder is not None]

    @cached_property
    def diagnosis(self) -> dict[str, Any] | None:
        """The diagnosis (docs/contract.md), or None where there is none."""
        return read_json(self.diagnose, "diagnosis.json")

    def evidence(self, file: str) -> Any:
        """Read one file of the evidence behind the diagnosis; None where it is absent or empty."""
        folder = self.diagnose / "evidence" if self.diagnose else None
        content = read_table(folder, file) if file.endswith(".parquet") else read_json(folder, file)
        return content if content is not None and len(content) else None

    @cached_property
    def recording_facts(self) -> dict[str, Any]:
        """What the cleaned recording's file says of itself; empty where there is no such file."""
        if self.clean is None or not (self.clean / "recording.parquet").is_file():
            return {}
        path = self.clean / "recording.parquet"
        metadata = _readable(path, lambda: parquet.read_schema(path).metadata or {})
        return {key.decode(): value.decode("utf-8", "replace") for key, value in metadata.items()}

    @cached_property
    def split(self) -> dict[str, str]:
        """Part (train, validation or holdout) of every run; empty where it is not known."""
        return json.loads(self.recording_facts.get("simgap.split") or "{}")


def read_json(folder: Path | None, file: str) -> Any:
    """Read a JSON file; None where it is absent, InputError where it is not JSON."""
    path = _existing(folder, file)
    return None if path is None else _readable(path, lambda: json.loads(path.read_text("utf-8")))


def read_yaml(folder: Path | None, file: str) -> Any:
    """Read a YAML file; None where it is absent, InputError where it is not YAML."""
    path = _existing(folder, file)
    return None if path is None else _readable(path, lambda: yaml.safe_load(path.read_text("utf-8")))


def read_table(folder: Path | None, file: str) -> pd.DataFrame | None:
    """Read a Parquet file; None where it is absent, InputError where it is not Parquet."""
    path = _existing(folder, file)
    return None if path is None else _readable(path, lambda: pd.read_parquet(path))


def _existing(folder: Path | None, file: str) -> Path | None:
    return folder / file if folder is not None and (folder / file).is_file() else None


def _readable(path: Path, read: Any) -> Any:
    try:
        return read()
    except (ValueError, OSError, yaml.YAMLError, pyarrow.ArrowException) as error:
        raise InputError("cannot be read", str(path), "run the stage that writes it again") from error
