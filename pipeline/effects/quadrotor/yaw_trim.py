"""Yaw torque that grows with the thrust, and that a healthy machine balances with its rotors."""

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.quadrotor.common import rotor_thrust
from simgap.physics.shapes import Channels


class YawTrim(WrenchEffect):
    """Thrust comes with a yaw torque, so that level hover needs one pair of rotors to turn faster than the other."""

    name = "yaw_trim"
    kind = "quadrotor"
    acts_on = "torque"
    parameters = (Parameter("imbalance", "1", 0.05, -1.0, 1.0),)
    needs = ("rotor_speed",)
    formula = "τ_z = imbalance · (torque_coefficient / thrust_coefficient) · T"
    # Two causes give this law. Torque coefficients of (1 + imbalance) and (1 − imbalance) times the nominal one for the
    # rotors of direction +1 and −1 give imbalance · torque_coefficient · Σ Ω², since a direction squared is one. Motors
    # that all lean the same way round about their arms turn a share of each thrust into a yaw torque.
    source = "Mahony, Kumar & Corke 2012, Multirotor aerial vehicles, eq. 4, with two torque coefficients"
    sentence = (
        "Thrust comes with a yaw torque, a fraction {imbalance} of the reaction torques of all rotors: motors lean "
        "slightly, or the propellers of the two directions differ. This is no damage; add it to the simulator."
    )
    excitation = "climb and descend hard without turning, then yaw quickly to both sides"
    symptom = "In hover both rotors of one direction turn faster than both of the other."
    look_alikes = ("rotor_thrust_spread", "rotor_fault")

    def stands_for(self, values: Values, constants: Values) -> float:
        """Return the share by which the torque coefficients of both directions are off."""
        return abs(float(values["imbalance"]))

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the yaw torque, N·m."""
        torque_per_thrust = constants["torque_coefficient"] / constants["thrust_coefficient"]
        thrust = rotor_thrust(signals, constants).sum(-1)
        return {"torque_z": values["imbalance"] * torque_per_thrust * thrust}
