"""The stage that cleans a recording and reports every change."""

from dataclasses import dataclass, field

from simgap.recordings.cleaning import Cleaning
from simgap.recordings.dataset import Dataset
from simgap.runner import StageConfig, StageRun, stage


@dataclass
class CleanStage(StageConfig):
    """The configuration of cleaning."""

    recording: str | None = None
    mapping: str | None = None
    dataset: Dataset = field(default_factory=Dataset)
    clean: Cleaning = field(default_factory=Cleaning)


@stage(CleanStage)
def clean(config: CleanStage, run: StageRun) -> None:
    """Clean a recording: resample, fill short gaps, remove unusable parts, split runs; report every change."""
    from simgap.logs.opening import open_recording
    from simgap.recordings.recording import write_recording

    path = run.input(config.recording or config.artifact("record", "recording.parquet"))
    recording = open_recording(path, mapping=run.input(config.mapping) if config.mapping else None)

    from simgap.recordings.cleaning import clean_with_coverage, summary
    from simgap.recordings.cleaning.figure import coverage_figure

    for warning in recording.warnings:
        run.warn(warning)
    cleaned = clean_with_coverage(recording, config.clean, config.dataset.split, config.seed)
    write_recording(cleaned.recording, run.output / "recording.parquet")
    cleaned.changes.to_parquet(run.output / "changes.parquet", index=False)
    cleaned.changes.to_csv(run.output / "changes.csv", index=False)
    cleaned.coverage.to_parquet(run.output / "coverage.parquet", index=False)
    (run.output / "coverage.svg").write_text(coverage_figure(cleaned.coverage), encoding="utf-8")
    table = summary(recording, cleaned)
    print(table.to_string())
    run.log_metrics(
        {
            "runs": len(cleaned.recording.runs),
            "samples": len(cleaned.recording.frame),
            "samples_recorded": len(recording.frame),
            "samples_dropped": int(table["dropped"].sum()),
            "samples_interpolated": int(table["interpolated"].sum()),
        }
    )


if __name__ == "__main__":
    from simgap.runner.command import main

    main(clean)
