"""The stage that provides the recording: published, a user's own, or made by a simulated plant."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from simgap.recordings.dataset import Dataset
from simgap.runner import StageConfig, StageRun, stage


@dataclass
class RecordStage(StageConfig):
    """The configuration of recording."""

    mapping: str | None = None
    platform: dict[str, Any] = field(default_factory=dict)
    dataset: Dataset = field(default_factory=Dataset)
    record: dict[str, Any] = field(default_factory=dict)


@stage(RecordStage)
def record(config: RecordStage, run: StageRun) -> None:
    """Get the recording: import a dataset, or run a simulated plant and seal its answer key."""
    from simgap.logs.load import load_dataset
    from simgap.recordings.recording import write_recording

    concealed = config.dataset.source == "reality"
    recording = _made(config, run) if concealed else load_dataset(config.dataset, config.mapping)
    for warning in recording.warnings:
        run.warn(warning)
    write_recording(recording, run.output / "recording.parquet")
    print(f"{len(recording.frame)} samples of {len(recording.runs)} runs: {recording.source}")
    run.log_metrics({"runs": len(recording.runs), "samples": len(recording.frame)})


def _made(config: RecordStage, run: StageRun) -> Any:
    """Run the configured case of the platform's kind; the key is written where no other stage reads."""
    from simgap.plants import case_from_config, record_case
    from simgap.plants.sealing import key_text
    from simgap.platforms import platform_from_config

    platform = platform_from_config(config.platform)
    case = case_from_config(platform.kind, config.record)
    recording, key = record_case(case, platform, config.seed)
    sealed = run.output / "key"
    sealed.mkdir()
    (sealed / "key.json").write_text(key_text(key), encoding="utf-8")
    return recording


def draw_cases(
    kind: str,
    table: Mapping[str, Any],
    shares: Mapping[str, float],
    machines: Mapping[str, Mapping[str, Any]],
    seed: int,
    count: int,
) -> list[Any]:
    """Draw the concealed cases of a benchmark; see `simgap.plants.concealed`."""
    from simgap.plants import concealed

    return concealed.draw_cases(kind, table, shares, machines, seed, count)


def record_drawn(case: Any) -> tuple[Any, dict[str, Any]]:
    """Return the recording of a drawn case and its key; see `simgap.plants.concealed`."""
    from simgap.plants.concealed import record_concealed

    return record_concealed(case)


def record_sealed(case: Any, path: Path, sealed: Path) -> str:
    """Record a drawn case and write its key where only the scorer reads.

    Args:
        case: of `draw_cases`.
        path: of the recording.
        sealed: of the key.

    Returns:
        The recording's source, which names the hash of the key.
    """
    from simgap.plants.sealing import key_text
    from simgap.recordings.recording import write_recording

    recording, key = record_drawn(case)
    path.parent.mkdir(parents=True, exist_ok=True)
    sealed.parent.mkdir(parents=True, exist_ok=True)
    write_recording(recording, path)
    sealed.write_text(key_text(key), encoding="utf-8")
    return recording.source


if __name__ == "__main__":
    from simgap.runner.command import main

    main(record)
