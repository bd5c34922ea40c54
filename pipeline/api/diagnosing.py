"""From a recording to an answer in one call."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from simgap.api.answer import Answer
from simgap.api.flow import diagnosed, nominal_simulator
from simgap.api.inputs import load_recording, platform_config, settings_of
from simgap.gap.settings import Gap
from simgap.platforms.settings import SimulatorSettings
from simgap.recordings.cleaning.settings import Cleaning
from simgap.recordings.split import Split

if TYPE_CHECKING:
    from simgap.api.inputs import PlatformLike, RecordingLike


@dataclass
class Runs:
    """What a diagnosis reads of the configuration group `dataset`."""

    split: Split = field(default_factory=Split)


@dataclass
class Settings:
    """The groups of the configuration that a diagnosis reads, with the values that conf/ has."""

    dataset: Runs = field(default_factory=Runs)
    clean: Cleaning = field(default_factory=Cleaning)
    simulator: SimulatorSettings = field(default_factory=SimulatorSettings)
    gap: Gap = field(default_factory=Gap)
    seed: int = 0


def diagnose(
    recording: "RecordingLike",
    platform: "PlatformLike",
    *,
    settings: Mapping[str, Any] | None = None,
    units: Mapping[str, str] | None = None,
    mapping: str | Path | None = None,
) -> Answer:
    """Say which physics the simulator of a machine lacks, by a recording of the machine.

    It does what `simgap diagnose` does, on one thread. It writes nothing: `Answer.save` and `Answer.report` do.

    Args:
        recording: the path of a log, a data frame or a mapping of columns; see `load_recording`.
        platform: what is known of the machine: the path of a YAML file, a mapping of its keys, a `Quadrotor`, `Swerve`
            or `Joint` of `simgap.platforms`, or the name of a platform that the package brings.
        settings: what differs from the configuration in conf/, nested as there, for example
            `{"gap": {"effects": ["coulomb_friction"]}, "dataset": {"split": {"holdout": ["run_7"]}}}`. The keys
            are `dataset.split`, `clean`, `simulator`, `gap` and `seed`, which draws runs that are held out by chance.
        units: the units of the columns of a data frame or mapping, where they are not the contract's.
        mapping: path of a YAML file that says which signal of a log is which column; `simgap inspect` proposes one.

    Returns:
        The answer, which holds the diagnosed simulator.

    Raises:
        InputError: when recording, platform or a setting cannot be used; one line says what, where and what to do.
    """
    chosen = settings_of(Settings, settings or {}, "settings")
    known = platform_config(platform)
    from simgap.platforms import platform_from_config

    read = load_recording(recording, platform_from_config(known).kind, units, mapping)
    name = Path(recording).name if isinstance(recording, str | Path) else "recording"
    nominal = nominal_simulator(read, known, chosen.simulator, name)
    found = diagnosed(read, nominal, chosen.gap, chosen.clean, chosen.dataset.split, chosen.seed)
    return Answer.of(found, name)
