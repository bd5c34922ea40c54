"""Configuration of residual models."""

from dataclasses import dataclass, field


@dataclass
class ObservationSettings:
    """Gaussian processes of what the on-board estimate gets wrong."""

    enabled: bool = True
    samples: int = 1000  # of the recording, evenly, that the processes know
    judged_by: int = 500  # of those, evenly: their likelihood chooses the hyperparameters
    iterations: int = 60  # of the search for the greatest marginal likelihood
    realisations: int = 100  # drawn from the posterior
    frequencies: int = 256  # random Fourier features of a draw from the prior
    anchors: int = 200  # points that carry what the data add to such a draw


@dataclass
class DynamicsSettings:
    """Nearest neighbours of the acceleration that the simulator leaves over."""

    enabled: bool = True
    samples: int = 1000
    neighbours: int = 5
    width: float = 0.1  # s, of the windows over which an acceleration is a mean


@dataclass
class ResidualSettings:
    """The configuration group `residual`."""

    recording: str | None = None  # of flights; null: what deploy wrote
    simulator: str = "diagnose"  # what the dynamics are a residual of; as in train_policy
    seconds: float | None = None  # of the recording that are used, from its start; null: all
    name_first: bool = (
        False  # whether what these seconds show is diagnosed first, and the residual what remains
    )
    scored_on: dict[str, str] = field(default_factory=dict)  # cleaned recordings to predict, by name
    score_horizon: float = 0.5  # s, of those predictions
    observation: ObservationSettings = field(default_factory=ObservationSettings)
    dynamics: DynamicsSettings = field(default_factory=DynamicsSettings)
