"""Configuration of the nominal simulator."""

from dataclasses import dataclass, field

TRAINED = "train"  # names the model that the branch trains


@dataclass
class SimulatorSettings:
    """Settings of the nominal simulator."""

    dynamics: str | None = None  # model that moves the machine: train, or a model's folder; null: the physics
    residual: str | None = None  # model of what the physics leave: train, or a model's folder; null: none
    identified: bool = False  # take the parameters that sysid found in place of the platform file's
    effects: dict[str, dict[str, float]] = field(
        default_factory=dict
    )  # effect to parameter to value, believed before
