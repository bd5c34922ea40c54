"""Configuration of a motion profile."""

from dataclasses import dataclass, field

from simgap.errors import InputError
from simgap.policies.settings import Learning


@dataclass
class Weights:
    """Of the rewards of a control step; all but the first and the last three are subtracted."""

    progress: float = 10.0  # per m towards the target
    over_voltage: float = 0.02  # share of the wanted voltage that cannot be had
    energy: float = 0.02  # of the voltage squared, over that of the limit squared
    consistency: float = 0.1  # of the spread of the wheels' speeds over the greatest speed
    smoothing: float = 0.05  # of the change of the voltage over its limit
    guidance: float = 0.1  # for every step that it takes
    arrival: float = 1000.0  # once, on arriving
    failure: float = -100.0  # once, on leaving the track
    final_speed: float = -50.0  # once, per m/s at the end


@dataclass
class Profile:
    """The way, the limits of the drive on it, and what counts as arriving."""

    simulators: list[str] = field(
        default_factory=lambda: ["identified"]
    )  # in each of which a policy is trained: identified, build_sim, diagnose, or a simulator's folder
    distance: float = 3.0  # m
    speed_limit: float = 3.0  # m/s, that a policy may ask for
    voltage_limit: float = 12.0  # V
    acceleration_limit: float = 10.0  # m/s², that the tyres bear
    period: float = 0.005  # s, for which a voltage is held
    episode: float = 3.0  # s, after which an attempt is cut off
    overrun: float = 0.5  # m beyond either end of the way, at which an attempt has failed
    tolerance: float = 0.05  # m, within which the target counts as reached
    speed_tolerance: float = 0.01  # m/s, below which the drive counts as standing
    wide: list[float] = field(default_factory=lambda: [0.5, 0.5])  # m and m/s: both, when training begins
    narrow: list[float] = field(default_factory=lambda: [0.01, 0.01])  # m and m/s: both, when it ends
    curriculum: int = 100  # equal factors by which they become narrow
    success: float = (
        0.8  # share of the attempts from rest in an update that have to arrive before the next of them
    )
    on_the_way: float = 0.5  # share of the attempts that start somewhere on the way, in motion
    weights: Weights = field(default_factory=Weights)
    learning: Learning = field(default_factory=Learning)

    def check(self) -> None:
        """Refuse a task in which nothing could be learnt.

        Raises:
            InputError: when no simulator is named, or a number is none to learn with.
        """
        if not self.simulators:
            raise InputError("names no simulator", "profile.simulators", "give [identified]")
        self.learning.check("profile.learning")
