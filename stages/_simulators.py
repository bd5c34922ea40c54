"""The simulator that a policy stage uses."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from simgap.runner import StageConfig, StageRun

if TYPE_CHECKING:
    from simgap.simulation import Simulator

IDEAL = "ideal"
_OF_STAGES = {"build_sim": "", "diagnose": "simulator", "identify_residual": "simulator"}


def chosen_simulator(
    choice: str, platform: Mapping[str, Any], config: StageConfig, run: StageRun
) -> "tuple[Simulator, str]":
    """Return a simulator and the hash of its file, which is empty for the platform's own dynamics.

    Args:
        choice: `ideal`, a stage of the branch that writes a simulator, or the folder of a simulator.
        platform: whose own dynamics `ideal` are.
        config: of the stage.
        run: of the stage.

    Raises:
        InputError: when there is no such simulator.
    """
    from pathlib import Path

    from simgap.platforms import platform_from_config
    from simgap.simulation import Simulator, read_simulator

    if choice == IDEAL:
        return Simulator(platform_from_config(platform)), ""
    folder = config.artifact(choice, _OF_STAGES[choice]) if choice in _OF_STAGES else Path(choice)
    file = run.input(folder / "simulator.yaml")
    return read_simulator(folder), run.inputs[str(file)]
