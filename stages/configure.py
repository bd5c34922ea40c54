"""The first stage: it checks and writes the configuration that all other stages read."""

from dataclasses import dataclass, field
from typing import Any

from simgap.runner import StageConfig, StageRun, stage


@dataclass
class ConfigureStage(StageConfig):
    """Every section of the configuration, as composed."""

    recording: str | None = None
    mapping: str | None = None
    platform: dict[str, Any] = field(default_factory=dict)
    dataset: dict[str, Any] = field(default_factory=dict)
    record: dict[str, Any] = field(default_factory=dict)
    clean: dict[str, Any] = field(default_factory=dict)
    sysid: dict[str, Any] = field(default_factory=dict)
    simulator: dict[str, Any] = field(default_factory=dict)
    gap: dict[str, Any] = field(default_factory=dict)
    model: dict[str, Any] = field(default_factory=dict)
    train: dict[str, Any] = field(default_factory=dict)
    track: dict[str, Any] = field(default_factory=dict)
    perception: dict[str, Any] = field(default_factory=dict)
    train_policy: dict[str, Any] = field(default_factory=dict)
    evaluate: dict[str, Any] = field(default_factory=dict)
    profile: dict[str, Any] = field(default_factory=dict)
    deploy: dict[str, Any] = field(default_factory=dict)
    residual: dict[str, Any] = field(default_factory=dict)
    finetune: dict[str, Any] = field(default_factory=dict)
    report: dict[str, Any] = field(default_factory=dict)
    prove: dict[str, Any] = field(default_factory=dict)


@stage(ConfigureStage)
def configure(config: ConfigureStage, run: StageRun) -> None:
    """Check and write the resolved configuration, so that DVC reruns only the stages that a change affects."""
    from dataclasses import asdict

    import yaml

    values = asdict(config)
    check(values)
    text = yaml.safe_dump(values, sort_keys=True, allow_unicode=True)
    (run.output / "config.yaml").write_text(text, encoding="utf-8")


def check(values: dict[str, Any]) -> None:
    """Check the configuration of every stage, so that mistakes show now and not after minutes of work.

    Raises:
        InputError: on a key that a stage does not know and on a value of the wrong type.
    """
    from importlib import import_module

    from simgap.runner.compose import typed
    from simgap.runner.project import commands, described

    for name in commands():
        if described(name):
            typed(getattr(import_module(f"simgap.stages.{name}"), name).config_class, values)


if __name__ == "__main__":
    from simgap.runner.command import main

    main(configure)
