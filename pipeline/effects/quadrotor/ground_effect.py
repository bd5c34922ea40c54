"""Thrust that rotors gain close to the floor."""

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.quadrotor.common import rotor_thrust
from simgap.physics.shapes import Channels

_LEAST_HEIGHT = 0.02  # m, rotor height on the landing gear


class GroundEffect(WrenchEffect):
    """Thrust grows near the floor at z = 0, with the inverse square of the height."""

    name = "ground_effect"
    kind = "quadrotor"
    acts_on = "force"
    parameters = (Parameter("coefficient", "m²", 1e-3, 0.0, 1.0),)
    needs = ("position", "rotor_speed")
    formula = "a_z = +coefficient / height² · T / m"
    source = (
        "Cheeseman & Bennett 1955, The effect of the ground on a helicopter rotor: R²/(16 h²) to first order"
    )
    sentence = (
        "At height h above the floor the thrust grows by {coefficient} m² / h²; add ground effect to the "
        "simulator."
    )
    excitation = "hover at several heights, from one rotor diameter down to landing"
    symptom = "Hover close to the floor needs less rotor speed than higher up."

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return specific force along body z, m/s²."""
        height = signals["position"][..., 2].clamp_min(_LEAST_HEIGHT)
        thrust = rotor_thrust(signals, constants).sum(-1)
        return {"force_z": values["coefficient"] / height.square() * thrust / constants["mass"]}
