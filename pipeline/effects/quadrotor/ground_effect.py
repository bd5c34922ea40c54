"""Thrust that rotors gain over a near floor."""

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.physics.shapes import Channels

_LEAST_HEIGHT = 0.02  # m; on the ground no rotor is nearer to it than its landing gear lets it be


class GroundEffect(WrenchEffect):
    """Thrust gained near the floor at z = 0, in proportion to the inverse square of height."""

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
        "Near the floor the rotors push harder: at height h the thrust grows by {coefficient} m² / h²; add ground "
        "effect to the simulator."
    )
    excitation = "hover at several heights from one rotor diameter down to landing"

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return specific force along body z, m/s²."""
        height = signals["position"][..., 2].clamp_min(_LEAST_HEIGHT)
        thrust = constants["thrust_coefficient"] * signals["rotor_speed"].square().sum(-1)
        return {"force_z": values["coefficient"] / height.square() * thrust / constants["mass"]}
