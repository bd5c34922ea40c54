"""Centre of mass away from the point that the rotors' lever arms refer to."""

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.quadrotor.common import rotor_thrust
from simgap.physics.shapes import Channels


class CenterOfMassOffset(WrenchEffect):
    """Thrust does not pass through the centre of mass, so it causes a torque."""

    name = "center_of_mass_offset"
    kind = "quadrotor"
    acts_on = "torque"
    parameters = (
        Parameter("offset_x", "m", 0.003, -0.1, 0.1),
        Parameter("offset_y", "m", 0.003, -0.1, 0.1),
    )
    needs = ("rotor_speed",)
    formula = "τ_x = −offset_y · T, τ_y = +offset_x · T"
    source = "rigid-body statics: τ = −c × T·e_z for a centre of mass at c"
    sentence = (
        "The centre of mass is off by {offset_x} m along x (forward) and {offset_y} m along y (left); move the battery "
        "or correct the simulator."
    )
    excitation = "climb and descend hard without turning, so that thrust changes while torque should not"
    symptom = "Hover needs a constant roll or pitch torque, which grows with the thrust."
    look_alikes = ("rotor_fault", "rotor_thrust_spread")

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the torque of the total thrust about the displaced centre, N·m."""
        thrust = rotor_thrust(signals, constants).sum(-1)
        return {"torque_x": -values["offset_y"] * thrust, "torque_y": values["offset_x"] * thrust}
