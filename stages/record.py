"""The stage that brings a recording in: published, a person's own, or flown by the concealed plant."""

from dataclasses import dataclass, field
from typing import Any

from pipeline.reality.case import PlantCase
from pipeline.recordings.dataset import Dataset
from pipeline.stage import StageConfig, StageRun, stage


@dataclass
class RecordStage(StageConfig):
    """What recording reads of the configuration."""

    platform: dict[str, Any] = field(default_factory=dict)
    dataset: Dataset = field(default_factory=Dataset)
    record: PlantCase = field(default_factory=PlantCase)


@stage(RecordStage)
def record(config: RecordStage, run: StageRun) -> None:
    """Record: fetch and import a dataset, or fly the concealed plant and seal its answer."""
    from pipeline.recordings.load import load_dataset
    from pipeline.recordings.recording import write_recording

    flown = config.dataset.source == "reality"
    recording = _flight(config, run) if flown else load_dataset(config.dataset)
    for warning in recording.warnings:
        run.warn(warning)
    write_recording(recording, run.output / "recording.parquet")
    print(f"{len(recording.frame)} samples of {len(recording.runs)} runs: {recording.source}")
    run.log_metrics({"runs": len(recording.runs), "samples": len(recording.frame)})


def _flight(config: RecordStage, run: StageRun) -> Any:
    """Fly the configured case; its key goes where no other stage looks."""
    from pipeline.errors import InputError
    from pipeline.platforms import Quadrotor, platform_from_config
    from pipeline.reality.fly import fly, key_text

    platform = platform_from_config(config.platform)
    if not isinstance(platform, Quadrotor):
        raise InputError(
            f"the concealed plant is a quadrotor, not a {platform.kind}", "platform", "use racer"
        )
    recording, key = fly(config.record, platform, config.seed)
    sealed = run.output / "key"
    sealed.mkdir()
    (sealed / "key.json").write_text(key_text(key), encoding="utf-8")
    return recording


if __name__ == "__main__":
    record.main()
