"""Configuration of identification and training."""

from dataclasses import dataclass, field


@dataclass
class SystemIdentification:
    """The configuration group `sysid`."""

    window: float = 0.2  # s, of the functions with which the equations of motion are averaged
    consistency: float = 0.1  # share by which a quadrotor's parameter may change when the window is doubled
    least_explained: float = 0.5  # share of the acceleration that a quadrotor's equation has to explain
    block_duration: float = 2.0  # s, longer than errors last: standard errors leave out one block at a time
    ridge: float = 1e-9  # penalty per sample on the motors' scaled coefficients
    motion_threshold: float = 0.02  # of the highest speed; a motor below it counts as standing
    motors: dict[str, list[str]] = field(default_factory=dict)  # motor: patterns of runs; empty: one motor


@dataclass
class Training:
    """The configuration group `train`."""

    enabled: bool = True  # false: nothing is trained, as where there is no run to hold out
    layout: str | None = None  # what is state, input, feature and target; null: the recording's kind says it
    max_epochs: int = 30
    patience: int = 6  # epochs without a better validation loss before training stops
    batch_size: int = 512  # windows
    steps: int = (
        1  # open-loop steps through which a network is trained further, once it predicts the next one
    )
    growth: float = 0.0  # share of the epochs in which these steps grow, evenly, to their number
    teacher_forcing: bool = (
        False  # whether these steps see recorded rates where velocities are learned, and the other way round
    )
    bias_correction: bool = (
        False  # whether predictions are corrected by a line that is fitted on validation runs
    )
    validation_windows: int | None = None  # by which one-step training stops, at most, evenly; null: all
    horizons: list[int] = field(default_factory=lambda: [1, 10, 50])  # steps at which rollouts are scored
    evaluation_windows: int = 2000  # at most, evenly over the held-out runs
    evaluation_history: int = (
        50  # samples before the first scored one: up to it, all windows see the same ones
    )
    quantiles: list[float] = field(default_factory=list)  # of the errors over the windows, beside their mean
    zero_phase: dict[str, float] | None = None  # Hz by channel, of filters that look ahead; null: none
    share: float = 1.0  # of the training data that is used
    shift: float = 0.0  # share of the training data before the part that is used
    free_run: float = 0.0  # s over which held-out runs are simulated from their inputs alone; 0: not
    test_windows: int = 0  # equal parts of the held-out time in each of which free runs are scored; 0: none
    residual_ratios: bool = False  # whether residuals are compared in size with what is predicted
    moving_window: float = 0.0  # s of held-out runs to which the model is fitted anew all along them; 0: not
    moving_step: float = 0.5  # s that such a fit predicts
    noise: float = 0.0  # standard deviation of white noise on all recorded inputs, over each one's own


@dataclass
class ModelSettings:
    """Settings of all learned models; each model adds its own (configuration group `model`)."""

    name: str = ""
    sequence_length: int = 1  # samples in the window from which the next is predicted
    scaling: str = "standard"  # standard (mean, standard deviation) or robust (median, interquartile range)


@dataclass
class TrainedSettings(ModelSettings):
    """Settings of all models with gradient-based training."""

    learning_rate: float = 1e-3  # of Adam
    weight_decay: float = 0.0  # L2 penalty
