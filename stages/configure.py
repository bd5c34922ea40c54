"""The first stage: the configuration that all the others read."""

from dataclasses import dataclass, field
from typing import Any

from pipeline.stage import StageConfig, StageRun, stage


@dataclass
class ConfigureStage(StageConfig):
    """Every section of the configuration, as composed."""

    recording: str | None = None
    platform: dict[str, Any] = field(default_factory=dict)
    dataset: dict[str, Any] = field(default_factory=dict)
    record: dict[str, Any] = field(default_factory=dict)
    clean: dict[str, Any] = field(default_factory=dict)
    sysid: dict[str, Any] = field(default_factory=dict)
    simulator: dict[str, Any] = field(default_factory=dict)
    gap: dict[str, Any] = field(default_factory=dict)
    model: dict[str, Any] = field(default_factory=dict)
    train: dict[str, Any] = field(default_factory=dict)
    report: dict[str, Any] = field(default_factory=dict)


@stage(ConfigureStage)
def configure(config: ConfigureStage, run: StageRun) -> None:
    """Write down the resolved configuration, by which `dvc repro` knows which stages a change concerns."""
    from dataclasses import asdict

    import yaml

    text = yaml.safe_dump(asdict(config), sort_keys=True, allow_unicode=True)
    (run.output / "config.yaml").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    configure.main()
