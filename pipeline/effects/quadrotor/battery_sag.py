"""Rotor speed that falls with the battery voltage."""

from typing import Any

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values
from simgap.physics.shapes import Real, Signal


class BatterySag(ActuatorEffect):
    """Rotor speed at a given command falls with the battery voltage."""

    name = "battery_sag"
    kind = "quadrotor"
    acts_on = "actuator"
    parameters = (Parameter("sensitivity", "1", 1.0, 0.0, 2.0),)
    needs = ("motor_command", "battery_voltage")
    driver = "battery_voltage"
    driver_at_rest = "nominal_voltage"
    formula = "Ω = motor_speed_max · command · (1 + sensitivity · (voltage / nominal_voltage − 1))"
    source = "Krishnan 2001, Electric motor drives, §2: the speed of an unregulated motor follows its voltage"
    sentence = (
        "Each percent of battery voltage costs {sensitivity} percent of rotor speed at the same command; "
        "scale the rotor speed with the voltage."
    )
    excitation = "fly the same manoeuvre on a full and on an empty battery, and punch the throttle"
    symptom = "The command that hover needs rises during the flight as the voltage falls."
    look_alikes = ("thrust_coefficient_error",)

    def load(self, signals: Signals, constants: Values) -> Real:
        """Return the rotors' shaft power, up to a factor: it loads the battery."""
        return (signals["rotor_speed"] ** 3).sum(-1)

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the rotor speed at the battery's voltage."""
        sag = signals["battery_voltage"] / constants["nominal_voltage"] - 1.0
        return {"rotor_speed": signals["rotor_speed"] * (1.0 + values["sensitivity"] * sag)[..., None]}, None
