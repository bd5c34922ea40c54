"""The configuration of the benchmark."""

from dataclasses import dataclass, field

from simgap.benchmark.settings import Benchmark
from simgap.gap.settings import Gap
from simgap.platforms.settings import SimulatorSettings
from simgap.recordings.cleaning.settings import Cleaning
from simgap.recordings.dataset import Dataset
from simgap.runner import StageConfig


@dataclass
class ProveStage(StageConfig):
    """The configuration of the benchmark."""

    dataset: Dataset = field(default_factory=Dataset)
    clean: Cleaning = field(default_factory=Cleaning)
    simulator: SimulatorSettings = field(default_factory=SimulatorSettings)
    gap: Gap = field(default_factory=Gap)
    prove: Benchmark = field(default_factory=Benchmark)
