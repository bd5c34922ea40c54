"""A case of a concealed attitude rig: its physics, motion and recording."""

from dataclasses import asdict, dataclass, field, fields
from typing import Any

from simgap.checks import check_not_negative, check_positive
from simgap.errors import InputError
from simgap.plants.case import PlantCase, Sensors
from simgap.plants.concealment import entry

ACTS_AT_REST = (
    "motor_lag",
    "command_delay",
    "battery_sag",
    "rotor_fault",
    "rotor_inertia_torque",
    "gyroscopic_torque",
    "angular_drag",
    "inertia_error",
    "thrust_coefficient_error",
    "torque_coefficient_error",
    "command_scale_error",
    "yaw_trim",
    "rotor_thrust_spread",
)
"""Effects of the catalogue that show on a machine whose place is fixed."""


@dataclass
class Gimbal:
    """The gimbal of the machine.

    Attributes:
        friction: of the bearings, N·m.
        give: angle over which the friction builds up, rad.
        damping: of the bearings, N·m·s/rad.
        rings: inertia that turns with the body about x, y, z, kg·m².
        skew: product of inertia of the x and z axes over the root of their moments' product.
        hanging: distance of the centre of mass below the point about which all turns, m.
        sideways: distance of the centre of mass before that point, m.
    """

    friction: float = 0.0
    give: float = 0.02
    damping: float = 0.0
    rings: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    skew: float = 0.0
    hanging: float = 0.0
    sideways: float = 0.0


@dataclass
class Pilot:
    """Stick inputs: a slowly varying attitude plus a pseudo-random part.

    Attributes:
        wander: root mean square of the attitude that is kept, about each axis, rad.
        eagerness: commanded rate over what the attitude is off, 1/s.
        shaking: greatest size of the pseudo-random part, rad/s.
        hold: mean time between two values of that part, s; the shortest is a sample.
        most: greatest command, rad/s.
    """

    wander: float = 0.3
    eagerness: float = 2.0
    shaking: float = 4.0
    hold: float = 0.08
    most: float = 8.0


@dataclass
class RigCase:
    """A set of runs of one concealed quadrotor in its gimbal.

    Attributes:
        effects: of the quadrotor, as in `PlantCase`, those of `ACTS_AT_REST` alone.
        runs: number of runs.
        duration: of each run, s.
        rate: of recording and commands, Hz.
        latency: from the pilot's command to the autopilot, s.
        quickening: greatest change of the rates that the autopilot asks for, rad/s²; 0: no limit.
        dropped: share of the samples that are lost.
        gimbal: what holds the machine.
        pilot: what the sticks do.
        sensors: noise of the sensors.
    """

    effects: dict[str, Any] = field(default_factory=dict)
    runs: int = 10
    duration: float = 25.0
    rate: float = 50.0
    latency: float = 0.0
    quickening: float = 0.0
    dropped: float = 0.0
    gimbal: Gimbal = field(default_factory=Gimbal)
    pilot: Pilot = field(default_factory=Pilot)
    sensors: Sensors = field(default_factory=Sensors)

    @property
    def plant(self) -> PlantCase:
        """The quadrotor by itself; its rotors feel how the body's turning moves them through the air."""
        return PlantCase(
            effects=self.effects,
            arm=1.0,
            runs=self.runs,
            duration=self.duration,
            rate=self.rate,
            autopilot="trimmed",
            dropped=self.dropped,
            sensors=self.sensors,
        )

    def check(self, where: str = "record") -> None:
        """Refuse a case that cannot be run.

        Raises:
            InputError: naming the key.
        """
        self.plant.check(where)
        for name in self.effects:
            if name not in ACTS_AT_REST:
                remedy = f"choose from {', '.join(ACTS_AT_REST)}"
                raise InputError("does not show where the place is fixed", f"{where}.effects.{name}", remedy)
        check_not_negative(self, ("latency", "quickening"), where)
        check_not_negative(self.gimbal, ("friction", "damping"), f"{where}.gimbal")
        check_positive(self.gimbal, ("give",), f"{where}.gimbal")
        check_not_negative(self.pilot, (entry.name for entry in fields(self.pilot)), f"{where}.pilot")
        if len(self.gimbal.rings) != 3 or min(self.gimbal.rings) < 0.0:
            raise InputError("needs three inertias", f"{where}.gimbal.rings", "give [x, y, z], kg·m²")
        if abs(self.gimbal.skew) >= 1.0:
            raise InputError("must be under 1", f"{where}.gimbal.skew", "correct it")

    def outside(self) -> list[dict[str, Any]]:
        """Return what the catalogue has no name for, as the key lists it."""
        gimbal = asdict(self.gimbal)
        rings = dict(zip(("rings_x", "rings_y", "rings_z"), gimbal.pop("rings"), strict=True))
        pilot = {"latency": self.latency, "quickening": self.quickening}
        return [entry("gimbal", gimbal | rings, _UNITS), entry("autopilot", pilot, _UNITS)]


_UNITS = {
    "friction": "N·m",
    "give": "rad",
    "damping": "N·m·s/rad",
    "rings_x": "kg·m²",
    "rings_y": "kg·m²",
    "rings_z": "kg·m²",
    "skew": "1",
    "hanging": "m",
    "sideways": "m",
    "latency": "s",
    "quickening": "rad/s²",
}
