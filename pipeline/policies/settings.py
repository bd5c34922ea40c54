"""Configuration of policies."""

from dataclasses import dataclass, field

from simgap.checks import check_not_negative, check_positive
from simgap.policies.racing.settings import RacingSettings


@dataclass
class Learning:
    """Proximal policy optimisation (Schulman et al. 2017, arXiv 1707.06347)."""

    interactions: int = 10_000_000  # control steps of all machines together
    machines: int = 4096  # that act at once
    horizon: int = 32  # control steps of every machine between two updates
    epochs: int = 4  # passes through the steps of an update
    minibatch: int = 16384  # control steps in a step of the optimiser
    learning_rate: float = 3e-4  # of Adam, at the start
    final_learning_rate: float = 3e-4  # at the end; in between it changes linearly
    discount: float = 0.99  # of the reward of the next step
    trace: float = 0.95  # λ of the generalised advantage estimate (Schulman et al. 2016, arXiv 1506.02438)
    clip: float = 0.2  # ratio of probabilities beyond which an update gains nothing
    entropy: float = 0.0  # weight of the entropy in the loss, at the start
    final_entropy: float = 0.0  # at the end
    critic: float = 0.5  # weight of the critic's error in the loss
    gradient_norm: float = 1.0  # to which a gradient is clipped
    reward_scale: float = 1.0  # by which rewards are multiplied, for returns of the order of one to ten
    hidden: list[int] = field(default_factory=lambda: [128, 128])  # widths of the layers of both networks
    slope: float = 0.2  # of LeakyReLU below zero
    deviation: float = 0.5  # standard deviation of the actions at the start; the range of an action is ±1
    checkpoint_every: int = 20  # updates after which a training that is killed goes on

    def check(self, where: str) -> None:
        """Refuse what nothing could be learnt with.

        Raises:
            InputError: on a number that has to be positive and is not.
        """
        counts = ("interactions", "machines", "horizon", "epochs", "minibatch", "checkpoint_every")
        check_positive(self, (*counts, "learning_rate", "clip", "gradient_norm", "deviation"), where)
        check_not_negative(
            self, ("final_learning_rate", "discount", "trace", "entropy", "final_entropy", "critic"), where
        )


@dataclass
class PolicyTraining:
    """The configuration group `train_policy`."""

    task: str | None = None  # racing; null: no policy is trained
    simulator: str = (
        "ideal"  # the platform's own; or build_sim, diagnose, identify_residual, or a simulator's folder
    )
    observation: str | None = None  # folder of a residual of observations; null: the state is known
    start: str | None = None  # folder of a policy to go on with; null: a new one
    start_deviation: float | None = None  # least deviation of its actions at first; null: as they are
    device: str = "cpu"
    learning: Learning = field(default_factory=Learning)
    racing: RacingSettings = field(default_factory=RacingSettings)


@dataclass
class PolicyFinetuning:
    """The configuration group `finetune`: settings that differ from those of the continued training."""

    enabled: bool = False
    policy: str | None = None  # folder; null: what train_policy wrote
    residual: str | None = None  # folder; null: what identify_residual wrote
    simulator: str | None = None  # as in train_policy; null: that of the residual
    randomised: bool = False  # whether dynamics that were drawn for every episode still are
    thrust: float = 0.0  # share by which the thrust of an episode may differ, as with the charge of a battery
    deviation: float | None = None  # of its actions at the start, at least; null: as the training left it
    interactions: int = 20_000_000
    learning_rate: float = 3e-4
    final_learning_rate: float = 1e-4

    def check(self) -> None:
        """Refuse what nothing could be learnt with.

        Raises:
            InputError: on a number that has to be positive and is not.
        """
        check_positive(self, ("interactions", "learning_rate"), "finetune")
        check_not_negative(self, ("final_learning_rate", "thrust"), "finetune")
        if self.deviation is not None:
            check_positive(self, ("deviation",), "finetune")


@dataclass
class PolicyEvaluation:
    """The configuration group `evaluate`."""

    pilot: str = "policy"  # or time_optimal: the plan of optimal control, tracked by model-predictive control
    policy: str | None = None  # folder; null: what train_policy wrote
    simulator: str = "ideal"  # as in train_policy
    powertrain: bool | None = None  # whether battery and motors are added; null: as in training
    starts: int = 100  # perturbed
    laps: int = 2
    seconds: float = 60.0  # after which a flight ends

    def check(self) -> None:
        """Refuse a race in which nobody flies.

        Raises:
            InputError: on a number that has to be positive and is not.
        """
        check_positive(self, ("starts", "laps", "seconds"), "evaluate")


@dataclass
class Deployment:
    """The configuration group `deploy`: trials of a motion and races on the concealed machine."""

    plan: str | None = None  # folder of the motions; null: what simgap profile wrote
    motion: str = "policy"  # which of them is driven
    beside: list[str] = field(default_factory=list)  # further ones, whose measures stand under their names
    window: int = 25  # periods over which its voltages are averaged; 1: they are driven as they are
    trials: int = 5
    scatter: float = (
        0.05  # by which the strength of what is concealed differs between trials, as a share of it
    )
    within: float = 0.03  # m, that a trial may end off the target
    gates: bool = True  # an estimator takes its drift off by the gates in view
    forgets: bool = True  # where gates are not looked for, drift is forgotten within 2 s; else it stays
    detector: str | None = (
        None  # folder; null: the branch's, if it asks for one, else gates by their distance
    )
    flights: int = 3  # races that are recorded at least
    recorded_seconds: float = 50.0  # of races that are recorded together, where enough are flown
    most_flights: int = 12  # races that are recorded at most

    def check(self) -> None:
        """Refuse a deployment of which nothing is left.

        Raises:
            InputError: on a number that has to be positive and is not.
        """
        check_positive(self, ("window", "trials", "flights", "recorded_seconds", "most_flights"), "deploy")
        check_not_negative(self, ("scatter", "within"), "deploy")
