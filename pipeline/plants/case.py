"""A case: concealed effects and the conditions of the recording."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from simgap.checks import check_not_negative, check_positive
from simgap.errors import InputError
from simgap.plants.concealable import CONCEALABLE, OUTSIDE, is_present, named_parameters
from simgap.plants.concealment import Table
from simgap.plants.conditions import check_logger, check_noise

FLIGHTS = ("auto", "varied", "low", "hover", "line", "level")
AUTOPILOTS = ("auto", "plain", "trimmed")
HIDEABLE = ("motor_speed", "motor_command", "battery_voltage", "specific_force")
_PLAIN = {
    "rotor_drag",
    "axial_inflow",
    "translational_lift",
    "body_drag",
    "motor_lag",
    "sensor_time_offset",
    "mass_error",
    "thrust_coefficient_error",
}  # effects that feedback of position and velocity alone can live with


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
        effects: by effect, its strength or a mapping of its parameters (see `CONCEALABLE`).
        outside: the same for physics that the catalogue has no name for (see `OUTSIDE`).
        arm: share of the hubs' distance from the centre of mass that the air knows of: over it the body's
            turning moves rotors through the air, and their in-plane forces twist the body. A real rotor has all
            of it; the damping of the turning is then `angular_drag`, which the key lists. 0 leaves forces alone.
        runs: number of flights.
        begins_in_run: run from which on the effects act, counted from 1; those before hold no effect.
        duration: of each flight, s.
        rate: of the recording, Hz.
        slowest: peak speed of the gentlest flight, m/s.
        fastest: peak speed of the wildest flight, m/s.
        acceleration: that the flights' paths are laid out for, m/s².
        excitation: scale of the multisine on thrust and body rates (see `dither`); 0 for none.
        flights: what is flown: `varied` manoeuvres; the same `low` over the floor, gently; `hover` on one spot;
            one `line` to and fro at a fixed heading; `level` at constant height. `auto` is `low` where a ground
            effect is concealed and `varied` elsewhere. All but the first two excite poorly on purpose.
        autopilot: `plain` feedback of position, velocity and attitude; `trimmed` integrates what stays wrong, waits
            for slow rotors and spares heavy ones; `auto` is `trimmed` where something concealed calls for it.
        charge: lowest and highest state of charge of the pack at the start of a run.
        battery_wear: factor on the pack's resistances.
        jitter: standard deviation of the sampling instant, s.
        dropped: share of the samples that are lost.
        hidden: channels, of `HIDEABLE`, that are not recorded.
        estimates: scale of the errors of an on-board estimator whose beliefs are recorded; 0 records none.
        sensors: noise of the sensors.
    """

    effects: dict[str, Any] = field(default_factory=dict)
    outside: dict[str, Any] = field(default_factory=dict)
    arm: float = 0.0
    runs: int = 10
    begins_in_run: int = 1
    duration: float = 15.0
    rate: float = 100.0
    slowest: float = 2.0
    fastest: float = 8.0
    acceleration: float = 10.0
    excitation: float = 1.0
    flights: str = "auto"
    autopilot: str = "auto"
    charge: list[float] = field(default_factory=lambda: [0.6, 1.0])
    battery_wear: float = 1.0
    jitter: float = 0.0
    dropped: float = 0.0
    hidden: list[str] = field(default_factory=list)
    estimates: float = 0.0
    sensors: Sensors = field(default_factory=Sensors)

    @cached_property
    def concealed(self) -> dict[str, dict[str, float]]:
        """The parameters of the effects that are not at their neutral strength."""
        return _present(self.effects, CONCEALABLE, "record.effects")

    @cached_property
    def unnamed(self) -> dict[str, dict[str, float]]:
        """The parameters of the physics outside the catalogue that is not at its neutral strength."""
        return _present(self.outside, OUTSIDE, "record.outside")

    @property
    def flown(self) -> str:
        """What is flown, `auto` resolved."""
        low = "low" if "ground_effect" in self.concealed else "varied"
        return low if self.flights == "auto" else self.flights

    @property
    def trimmed(self) -> bool:
        """Whether the autopilot integrates, `auto` resolved."""
        called_for = bool(self.unnamed or set(self.concealed) - _PLAIN or self.flown == "low")
        return called_for if self.autopilot == "auto" else self.autopilot == "trimmed"

    def strength(self, effect: str, parameter: str = "") -> float:
        """Return a parameter of an effect, its first if none is named; neutral where it is not concealed."""
        table = CONCEALABLE if effect in CONCEALABLE else OUTSIDE
        parameter = parameter or next(iter(table[effect]))
        present = self.concealed if effect in CONCEALABLE else self.unnamed
        return present[effect][parameter] if effect in present else table[effect][parameter].neutral

    def check(self, where: str = "record") -> None:
        """Refuse a case that cannot be flown.

        Raises:
            InputError: naming the key.
        """
        named_parameters(self.effects, CONCEALABLE, f"{where}.effects")
        named_parameters(self.outside, OUTSIDE, f"{where}.outside")
        positive = ("runs", "duration", "rate", "slowest", "fastest", "acceleration", "battery_wear")
        check_positive(self, positive, where)
        check_not_negative(self, ("excitation", "arm", "estimates"), where)
        self._check_sampling(where)
        self._check_choices(where)

    def _check_sampling(self, where: str) -> None:
        check_logger(self.rate, self.jitter, self.dropped, where)
        check_noise(self.sensors, f"{where}.sensors")
        if len(self.charge) != 2 or not 0.1 <= self.charge[0] <= self.charge[1] <= 1.0:
            raise InputError(
                f"must be two shares from 0.1 to 1, is {self.charge}", f"{where}.charge", "give [low, high]"
            )

    def _check_choices(self, where: str) -> None:
        for key, known in (("flights", FLIGHTS), ("autopilot", AUTOPILOTS)):
            if getattr(self, key) not in known:
                raise InputError(
                    f"unknown choice {getattr(self, key)!r}",
                    f"{where}.{key}",
                    f"give one of {', '.join(known)}",
                )
        if set(self.hidden) - set(HIDEABLE) or {"motor_speed", "motor_command"} <= set(self.hidden):
            raise InputError(
                f"cannot hide {', '.join(self.hidden)}",
                f"{where}.hidden",
                f"give some of {', '.join(HIDEABLE)}, and leave motor_speed or motor_command",
            )
        blown = [name for name in ("steady_wind", "gusts") if name in {*self.concealed, *self.unnamed}]
        if blown and not {"rotor_drag", "body_drag"} & set(self.concealed):
            raise InputError(
                f"{blown[0]} moves nothing without drag",
                f"{where}.effects",
                "conceal rotor_drag or body_drag as well",
            )


def _present(given: Mapping[str, Any], table: Table, where: str) -> dict[str, dict[str, float]]:
    """Return the parameters of what is not neutral, in the order of the table."""
    named = named_parameters(given, table, where)
    return {name: named[name] for name in table if name in named and is_present(named[name], table[name])}
