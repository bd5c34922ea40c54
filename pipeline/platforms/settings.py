"""Configuration of the nominal simulator."""

from dataclasses import dataclass, field


@dataclass
class SimulatorSettings:
    """Settings of the nominal simulator."""

    identified: bool = False  # take the parameters that sysid found in place of the platform file's
    effects: dict[str, dict[str, float]] = field(
        default_factory=dict
    )  # effect to parameter to value, believed before
