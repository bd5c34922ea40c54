"""Configuration of racing."""

from dataclasses import dataclass, field

TASK = "racing"


@dataclass
class Reward:
    """r = r_prog + r_perc + r_cmd − r_crash per control step (Kaufmann et al. 2023, Nature 620, Methods)."""

    progress: float = 1.0  # λ1, per m that the next gate comes nearer
    perception: float = 0.02  # λ2, for looking at the next gate
    perception_angle: float = -10.0  # λ3, 1/rad⁴
    rates: float = -2e-4  # λ4, per rad/s that is commanded
    change: float = -1e-4  # λ5, per squared change of the command, m/s² and rad/s
    crash: float = 5.0
    first_crash: float | None = (
        None  # what it costs as training begins, from where it rises evenly; None: the same
    )
    camera_pitch: float = 0.35  # rad by which the camera looks up from the body's x axis


@dataclass
class Starts:
    """Where episodes start: near a state in which some machine has passed a gate."""

    kept: int = 256  # states of each gate
    slow: float = 0.25  # share of them that stay as they are before any machine has passed: a race begins so
    planned: float = 0.0  # share of them that are, and stay, states of the time-optimal lap
    speed: float = 3.0  # m/s, towards the next gate, before any machine has passed
    position: float = 0.3  # m, greatest perturbation along each axis
    velocity: float = 0.5  # m/s
    attitude: float = 0.1  # rad about each axis
    body_rate: float = 0.5  # rad/s


@dataclass
class Flying:
    """The machine and what is commanded."""

    period: float = 0.01  # s between two actions
    substeps: int = 5  # of the physics and the rate controller in a period
    integrator: str = "rk4"
    time_constant: float = 0.033  # s, of the motors, for which the rate controller is tuned
    powertrain: bool = True  # battery, speed controllers and motors; false where the simulator names its own
    effects: dict[str, dict[str, float]] = field(
        default_factory=dict
    )  # of the catalogue, beside the simulator's
    thrust: float = 35.0  # m/s², greatest that is commanded
    rate: float = 10.0  # rad/s, greatest about body x and y
    yaw_rate: float = 4.0  # rad/s, greatest about body z


@dataclass
class Randomisation:
    """Bounds of the random dynamics of each episode; all zero: none."""

    drag: float = 0.0  # 1/s, of the force against the velocity along each body axis
    thrust: float = 0.0  # share by which the thrust differs from the commanded one
    angular_acceleration: float = 0.0  # rad/s² about each body axis, of a constant torque

    @property
    def enabled(self) -> bool:
        """Whether anything is drawn."""
        return any((self.drag, self.thrust, self.angular_acceleration))


@dataclass
class RacingSettings:
    """Settings of a race and its reward."""

    episode_steps: int = 1500
    missed: float = 2.0  # m beside the next gate's frame, within which flying past it counts as a crash
    flying: Flying = field(default_factory=Flying)
    reward: Reward = field(default_factory=Reward)
    starts: Starts = field(default_factory=Starts)
    randomisation: Randomisation = field(default_factory=Randomisation)
