"""Battery voltage that reaches the motors of a swerve drive.

A controller that only sets a duty cycle has a sensitivity of one. A controller that compensates for the battery has a
sensitivity of zero. At the motors' nominal voltage they get the commanded voltage.
"""

from typing import Any

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values
from simgap.physics.shapes import Real, Signal


class _SwerveBatterySag(ActuatorEffect):
    """The motors' voltage falls with the battery voltage."""

    name = "battery_sag"
    kind = "swerve"
    parameters = (Parameter("sensitivity", "1", 1.0, 0.0, 2.0),)
    needs = ("battery_voltage",)
    formula = "voltage_effective = voltage · (1 + sensitivity · (battery_voltage / nominal_voltage − 1))"
    source = "Mohan 2003, Electric drives, §4: the mean voltage of a pulse-width-modulated converter"
    excitation = "repeat the same motion on a full and on an empty battery, or under heavy and light load"
    symptom = "The same commanded voltage gives less torque and speed as the battery voltage falls."
    look_alikes = ("motor_constant_error",)

    def load(self, signals: Signals, constants: Values) -> Real:
        """Return the power that all motors draw from their battery, W at nominal torque constants."""
        power = [
            (signals[f"{group}_voltage"] * signals[f"{group}_torque"]).sum(-1)
            / (constants[f"{group}_torque_constant"] * constants[f"{group}_gear_ratio"])
            for group in ("drive", "steer")
        ]
        return power[0] + power[1]

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the voltages at the motors, and the torques that they make."""
        group = self.acts_on
        relative = signals["battery_voltage"] / constants[f"{group}_nominal_voltage"] - 1.0
        change = signals[f"{group}_voltage"] * values["sensitivity"] * relative[..., None]
        gain = constants[f"{group}_torque_constant"] * constants[f"{group}_gear_ratio"]
        return {
            f"{group}_voltage": signals[f"{group}_voltage"] + change,
            f"{group}_torque": signals[f"{group}_torque"] + gain / constants[f"{group}_resistance"] * change,
        }, None


class DriveBatterySag(_SwerveBatterySag):
    """The drive motors' voltage falls with the battery voltage."""

    acts_on = "drive"
    driver = "battery_voltage"
    driver_at_rest = "drive_nominal_voltage"
    sentence = (
        "The drive motors' voltage follows relative changes of the battery with a sensitivity of "
        "{sensitivity}; scale it in the simulator."
    )


class SteerBatterySag(_SwerveBatterySag):
    """The steering motors' voltage falls with the battery voltage."""

    acts_on = "steer"
    driver = "battery_voltage"
    driver_at_rest = "steer_nominal_voltage"
    sentence = (
        "The steering motors' voltage follows relative changes of the battery with a sensitivity of "
        "{sensitivity}; scale it in the simulator."
    )
