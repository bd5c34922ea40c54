"""A case of a concealed joint: its physics, motion and recording."""

from dataclasses import dataclass, field

from simgap.checks import check_positive
from simgap.errors import InputError
from simgap.plants.concealment import Concealed, check_chosen
from simgap.plants.conditions import check_gentlest, check_listed, check_logger, check_noise
from simgap.plants.joint.effects import CONCEALABLE, NEEDS_CONTROLLER, NEEDS_MOTOR, OUTSIDE
from simgap.platforms import Joint

REFERENCES = ("multisine", "chirp", "steps", "triangle", "creep", "sine", "one_way")
DISPENSABLE = ("velocity",)
RECORDABLE = ("current", "battery_voltage", "temperature")


@dataclass
class JointSensors:
    """Standard deviations of white noise, and steps of quantisation, in the units of the machine.

    Attributes:
        scale: on all figures below; 0 gives perfect sensors.
        position: rad or m.
        position_step: of the encoder, rad or m.
        velocity: of a velocity that is measured by itself, rad/s or m/s.
        velocity_window: time over which the encoder is differenced for the velocity, s; 0: measured by itself.
        effort: of the recorded effort, N·m or N.
        voltage_step: of the recorded voltage, V.
        current: A.
        battery_voltage: V.
        temperature: K.
    """

    scale: float = 1.0
    position: float = 2e-4
    position_step: float = 3.8e-4
    velocity: float = 5e-3
    velocity_window: float = 0.0
    effort: float = 0.0
    voltage_step: float = 0.01
    current: float = 0.02
    battery_voltage: float = 0.02
    temperature: float = 0.2


@dataclass
class JointCase:
    """A set of runs of one concealed joint.

    Attributes:
        effects: values by effect of the catalogue and quantity (see `effects.CONCEALABLE`).
        outside: the same for physics that the catalogue has no name for (see `effects.OUTSIDE`).
        sliding: whether the unit of position is m.
        references: what the joint is told to follow, in turn over the runs (see `REFERENCES`).
        runs: number of runs.
        begins_in_run: run from which on the effects act, counted from 1; those before hold no effect.
        duration: of each run, s.
        rate: of the recording, Hz.
        amplitude: greatest position of the widest run, rad or m.
        velocity: greatest of the fastest run, rad/s or m/s.
        acceleration: greatest, rad/s² or m/s².
        gentlest: size of the gentlest run over that of the wildest.
        bandwidth: of the position loop, rad/s.
        held: whether commands change only when a sample is taken.
        supply: greatest voltage, V, where a voltage drives the machine.
        without: what is not recorded: of a joint its velocity can be left out.
        channels: what is recorded besides position, velocity and input (see `RECORDABLE`).
        jitter: standard deviation of the sampling instant, s.
        dropped: share of the samples that are lost.
        sensors: noise of the sensors.
    """

    effects: dict[str, dict[str, float]] = field(default_factory=dict)
    outside: dict[str, dict[str, float]] = field(default_factory=dict)
    sliding: bool = False
    references: list[str] = field(default_factory=lambda: ["multisine", "chirp", "steps", "triangle"])
    runs: int = 10
    begins_in_run: int = 1
    duration: float = 10.0
    rate: float = 200.0
    amplitude: float = 1.2
    velocity: float = 5.0
    acceleration: float = 60.0
    gentlest: float = 0.35
    bandwidth: float = 25.0
    held: bool = False
    supply: float = 12.0
    without: list[str] = field(default_factory=list)
    channels: list[str] = field(default_factory=list)
    jitter: float = 0.0
    dropped: float = 0.002
    sensors: JointSensors = field(default_factory=JointSensors)

    def check(self, where: str = "record") -> None:
        """Refuse a case that cannot be run.

        Raises:
            InputError: naming the key.
        """
        check_chosen(self.effects, CONCEALABLE, f"{where}.effects")
        check_chosen(self.outside, OUTSIDE, f"{where}.outside")
        positive = (
            "runs",
            "duration",
            "rate",
            "amplitude",
            "velocity",
            "acceleration",
            "bandwidth",
            "supply",
        )
        check_positive(self, positive, where)
        check_gentlest(self.gentlest, where)
        check_listed(self.references, REFERENCES, f"{where}.references")
        check_listed(self.without, DISPENSABLE, f"{where}.without", least=0)
        check_listed(self.channels, RECORDABLE, f"{where}.channels", least=0)
        check_logger(self.rate, self.jitter, self.dropped, where)
        check_noise(self.sensors, f"{where}.sensors")

    def check_machine(self, platform: Joint, where: str = "record") -> None:
        """Refuse what this machine cannot conceal.

        Raises:
            InputError: naming the effect.
        """
        told = platform.controller is not None
        lacking = {"motor": [] if platform.motor and not told else NEEDS_MOTOR}
        lacking["controller"] = [] if told else NEEDS_CONTROLLER
        for part, names in lacking.items():
            for name in names:
                if name in self.effects:
                    remedy = f"choose a platform that is driven by a {part}"
                    raise InputError(f"needs a {part}", f"{where}.effects.{name}", remedy)
        if platform.controller is not None and platform.controller.unknown:
            gain = platform.controller.unknown[0]
            raise InputError(
                "is unknown", f"platform.controller.{gain}", "give it: the servo needs its gains"
            )
        if self.sliding and "gravity_load" in self.effects:
            raise InputError(
                "turns no sliding axis", f"{where}.effects.gravity_load", "conceal a constant_load"
            )
        if {"backlash", "flexible_coupling"} <= set(self.effects):
            raise InputError("excludes backlash", f"{where}.effects.flexible_coupling", "leave out either")

    def concealed(self, platform: Joint) -> tuple[Concealed, Concealed]:
        """Return what is concealed in a machine: effects of the catalogue, and those outside it."""
        size = self.size(platform)
        return Concealed(self.effects, CONCEALABLE, size), Concealed(self.outside, OUTSIDE, size)

    def size(self, platform: Joint) -> dict[str, float]:
        """Return what is typical of the machine in this case: half its greatest load, and so on."""
        load = abs(platform.gravity_torque) + platform.stiffness * self.amplitude
        effort = 0.5 * (platform.inertia * self.acceleration + load)
        size = {"effort": effort, "position": self.amplitude, "velocity": 0.5 * self.velocity}
        if platform.motor is None or platform.controller is not None:
            return size | {"current": effort, "command": effort}
        constant = platform.motor.torque_constant * platform.motor.gear_ratio
        current = effort / constant
        command = platform.motor.resistance * current + constant * size["velocity"]
        return size | {"current": current, "command": command}
