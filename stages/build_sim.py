"""The stage that builds the nominal simulator."""

from dataclasses import dataclass, field, replace
from typing import Any

from simgap.platforms.settings import SimulatorSettings
from simgap.runner import StageConfig, StageRun, stage

BLOCK_DURATION = 1.0  # s
MARGIN = 0.1  # s


@dataclass
class BuildSimStage(StageConfig):
    """The configuration of building a simulator."""

    recording: str | None = None
    platform: dict[str, Any] = field(default_factory=dict)
    simulator: SimulatorSettings = field(default_factory=SimulatorSettings)


@stage(BuildSimStage)
def build_sim(config: BuildSimStage, run: StageRun) -> None:
    """Build the nominal simulator from platform, identified parameters, named effects and a learned part."""
    from simgap.platforms import platform_assumptions
    from simgap.recordings.recording import read_recording, require_kind
    from simgap.simulation import replay_error, write_simulator
    from simgap.simulation.blocks import cut_blocks
    from simgap.simulation.build import build_simulator
    from simgap.stages._simulators import learned_part

    path = run.input(config.recording or config.artifact("clean", "recording.parquet"))
    recording = read_recording(path)
    identified = None
    if config.simulator.identified:
        identified = run.input(config.artifact("sysid", "parameters.yaml"))
    simulator = build_simulator(config.platform, config.simulator, recording.units, identified)
    require_kind(recording, simulator.platform.kind, str(path))
    learned = learned_part(config.simulator, simulator.platform, config, run)
    simulator = replace(simulator, learned=learned)
    write_simulator(simulator, run.output)
    blocks = cut_blocks(recording, simulator.platform, BLOCK_DURATION, MARGIN)
    run.log_metrics(replay_error(simulator, blocks, BLOCK_DURATION / 2))
    for assumption in platform_assumptions(config.platform):
        run.warn(assumption)


if __name__ == "__main__":
    from simgap.runner.command import main

    main(build_sim)
