"""A battery whose voltage the motors of a swerve drive get a part of.

A controller that sets its duty has a sensitivity of one, one that makes up for the battery a sensitivity of zero. At
the motors' nominal voltage they get what is commanded.
"""

from typing import Any

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values
from simgap.physics.shapes import Real, Signal


class _SwerveBatterySag(ActuatorEffect):
    """The motors get a part of the battery's voltage, not a voltage: with the battery it falls."""

    name = "battery_sag"
    kind = "swerve"
    parameters = (Parameter("sensitivity", "1", 1.0, 0.0, 2.0),)
    needs = ("battery_voltage",)
    formula = "voltage_effective = voltage · (1 + sensitivity · (battery_voltage / nominal_voltage − 1))"
    source = "Mohan 2003, Electric drives, §4: the mean voltage of a pulse-width-modulated converter"
    excitation = "the same motion with a full and with an empty battery, or under heavy load and light"

    def load(self, signals: Signals, constants: Values) -> Real:
        """Return what all motors draw from the battery that they share, W at nominal torque constants."""
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
    """The drive motors' voltage falls with the battery's."""

    acts_on = "drive"
    driver = "battery_voltage"
    driver_at_rest = "drive_nominal_voltage"
    sentence = (
        "The drive motors' voltage falls by {sensitivity} of the share that the battery loses of their nominal "
        "voltage; scale it in the simulator."
    )


class SteerBatterySag(_SwerveBatterySag):
    """The steering motors' voltage falls with the battery's."""

    acts_on = "steer"
    driver = "battery_voltage"
    driver_at_rest = "steer_nominal_voltage"
    sentence = (
        "The steering motors' voltage falls by {sensitivity} of the share that the battery loses of their nominal "
        "voltage; scale it in the simulator."
    )
