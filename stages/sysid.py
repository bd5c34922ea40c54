"""The stage that identifies the nominal parameters of a machine."""

from dataclasses import dataclass, field
from typing import Any

from simgap.models.settings import SystemIdentification
from simgap.runner import StageConfig, StageRun, stage


@dataclass
class SysidStage(StageConfig):
    """The configuration of identification."""

    recording: str | None = None
    platform: dict[str, Any] = field(default_factory=dict)
    sysid: SystemIdentification = field(default_factory=SystemIdentification)


@stage(SysidStage)
def sysid(config: SysidStage, run: StageRun) -> None:
    """Identify nominal parameters by least squares, with standard errors."""
    import json

    from simgap.models.identify import identify
    from simgap.models.parameters import write_parameters
    from simgap.platforms import platform_from_config
    from simgap.recordings.recording import read_recording, require_kind

    path = run.input(config.recording or config.artifact("clean", "recording.parquet"))
    recording = read_recording(path)
    platform = platform_from_config(config.platform)
    require_kind(recording, platform.kind, str(path))
    found = identify(recording, platform, config.sysid, config.seed)
    for warning in found.warnings:
        run.warn(warning)
    write_parameters(found.parameters, run.output / "parameters.yaml")
    (run.output / "metrics.json").write_text(json.dumps(found.metrics, indent=2) + "\n")
    run.log_metrics(
        {f"{name}/{key}": value for name, scores in found.metrics.items() for key, value in scores.items()}
    )


if __name__ == "__main__":
    from simgap.runner.command import main

    main(sysid)
