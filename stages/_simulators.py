"""The simulator that a policy stage uses, and its learned part."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from simgap.platforms.settings import TRAINED, SimulatorSettings
from simgap.runner import StageConfig, StageRun

if TYPE_CHECKING:
    from simgap.platforms import Platform
    from simgap.simulation import Simulator
    from simgap.simulation.learned import Learned

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

    from simgap.models.simulated import read_learned_simulator
    from simgap.platforms import platform_from_config
    from simgap.simulation import Simulator

    if choice == IDEAL:
        return Simulator(platform_from_config(platform)), ""
    folder = config.artifact(choice, _OF_STAGES[choice]) if choice in _OF_STAGES else Path(choice)
    file = run.input(folder / "simulator.yaml")
    return read_learned_simulator(folder), run.inputs[str(file)]


def learned_part(
    settings: SimulatorSettings, platform: "Platform", config: StageConfig, run: StageRun
) -> "Learned | None":
    """Return the learned part that the settings of a simulator name; None where it is physics alone.

    Args:
        settings: of the simulator.
        platform: of the simulator.
        config: of the stage.
        run: of the stage.

    Raises:
        InputError: when there is no such model, it cannot be that part, or both parts are named.
    """
    from pathlib import Path

    from simgap.errors import InputError
    from simgap.models.simulated import load_learned
    from simgap.simulation.learned import DYNAMICS, RESIDUAL

    named = {role: getattr(settings, role) for role in (DYNAMICS, RESIDUAL) if getattr(settings, role)}
    if len(named) > 1:
        raise InputError("is beside learned dynamics", "simulator.residual", "set one of the two to null")
    for role, choice in named.items():
        folder = config.artifact("train", "model") if choice == TRAINED else Path(choice)
        return load_learned(run.input(folder), platform, role)
    return None
