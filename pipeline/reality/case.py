"""What is concealed, and under which conditions it is recorded."""

import difflib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields

from pipeline.errors import InputError


@dataclass(frozen=True)
class Concealable:
    """An effect that a plant can be given.

    Attributes:
        parameter: the name of its strength in a diagnosis.
        unit: of the strength.
        neutral: the strength at which the effect is absent.
        low: the least strength that makes sense.
    """

    parameter: str
    unit: str
    neutral: float = 0.0
    low: float = 0.0


CONCEALABLE = {
    "rotor_drag": Concealable("coefficient", "1/s"),
    "axial_inflow": Concealable("coefficient", "1/s"),
    "translational_lift": Concealable("coefficient", "1/m"),
    "body_drag": Concealable("coefficient", "1/m"),
    "motor_lag": Concealable("time_constant", "s"),
    "sensor_time_offset": Concealable("offset", "s", low=-1.0),
    "mass_error": Concealable("ratio", "1", neutral=1.0, low=0.1),
    "thrust_coefficient_error": Concealable("ratio", "1", neutral=1.0, low=0.1),
}


@dataclass
class Sensors:
    """Standard deviations of white noise, and steps of quantisation.

    Motion capture, a consumer inertial unit of 16 bits over ±2000 °/s and ±16 g, and rotor
    speed from bidirectional DShot.

    Attributes:
        scale: on all figures below; 0 gives perfect sensors.
        position: m.
        attitude: rad, about each body axis.
        velocity: m/s.
        body_rate: rad/s.
        body_rate_step: rad/s.
        specific_force: m/s².
        specific_force_step: m/s².
        motor_speed: rad/s.
        motor_speed_step: rad/s.
        battery_voltage: V.
        battery_voltage_step: V.
    """

    scale: float = 1.0
    position: float = 0.001
    attitude: float = 0.002
    velocity: float = 0.01
    body_rate: float = 0.015
    body_rate_step: float = 0.001065
    specific_force: float = 0.15
    specific_force_step: float = 0.00479
    motor_speed: float = 2.0
    motor_speed_step: float = 1.5
    battery_voltage: float = 0.01
    battery_voltage_step: float = 0.01


@dataclass
class PlantCase:
    """A set of flights of one concealed plant.

    Attributes:
        effects: strength by effect name, in the unit that the diagnosis uses (see `CONCEALABLE`).
        arm: share of the hubs' distance from the centre of mass that the air knows of: over it the body's
            turning moves rotors through the air, and their in-plane forces twist the body. A real rotor has all
            of it; the damping of the turning is then `angular_drag`, which the key lists. 0 leaves forces alone.
        runs: number of flights.
        duration: of each flight, s.
        rate: of the recording, Hz.
        slowest: peak speed of the gentlest flight, m/s.
        fastest: peak speed of the wildest flight, m/s.
        acceleration: that the flights' paths are laid out for, m/s².
        excitation: scale of the multisine on thrust and body rates (see `dither`); 0 for none.
        jitter: standard deviation of the sampling instant, s.
        dropped: share of the samples that are lost.
        sensors: noise of the sensors.
    """

    effects: dict[str, float] = field(default_factory=dict)
    arm: float = 0.0
    runs: int = 10
    duration: float = 15.0
    rate: float = 100.0
    slowest: float = 2.0
    fastest: float = 8.0
    acceleration: float = 10.0
    excitation: float = 1.0
    jitter: float = 0.0
    dropped: float = 0.0
    sensors: Sensors = field(default_factory=Sensors)

    def strength(self, effect: str) -> float:
        """Return the strength of an effect, neutral where it is not concealed."""
        return float(self.effects.get(effect, CONCEALABLE[effect].neutral))

    def check(self, where: str = "record") -> None:
        """Refuse a case that cannot be flown.

        Raises:
            InputError: naming the key.
        """
        _check_effects(self.effects, f"{where}.effects")
        for key in ("runs", "duration", "rate", "slowest", "fastest", "acceleration"):
            if getattr(self, key) <= 0:
                raise InputError(f"must be positive, is {getattr(self, key)}", f"{where}.{key}", "correct it")
        for key in ("excitation", "arm"):
            if getattr(self, key) < 0:
                raise InputError("must not be negative", f"{where}.{key}", "give 0 or more")
        if not 0 <= self.dropped < 0.9:
            raise InputError(f"must be from 0 to 0.9, is {self.dropped}", f"{where}.dropped", "give a share")
        if not 0 <= self.jitter * self.rate < 0.2:
            raise InputError(
                f"must be under a fifth of the time step, is {self.jitter}", f"{where}.jitter", "give seconds"
            )
        for entry in fields(self.sensors):
            if getattr(self.sensors, entry.name) < 0:
                raise InputError("must not be negative", f"{where}.sensors.{entry.name}", "correct it")


def _check_effects(effects: Mapping[str, float], where: str) -> None:
    for name, strength in effects.items():
        if name not in CONCEALABLE:
            near = difflib.get_close_matches(str(name), CONCEALABLE, n=1)
            remedy = f"did you mean {near[0]!r}?" if near else f"the plant knows {', '.join(CONCEALABLE)}"
            raise InputError(f"unknown effect {name!r}", where, remedy)
        if strength < CONCEALABLE[name].low:
            raise InputError(
                f"must be at least {CONCEALABLE[name].low}, is {strength}", f"{where}.{name}", "correct it"
            )
