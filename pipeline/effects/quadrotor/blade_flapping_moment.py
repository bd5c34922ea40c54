"""The moment of rotors whose discs tilt back in forward flight."""

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.quadrotor.common import rotor_speed_ratio
from simgap.physics.shapes import Channels


class BladeFlappingMoment(WrenchEffect):
    """Roll and pitch torque proportional to in-plane airspeed, lifting the side that meets the air."""

    name = "blade_flapping_moment"
    kind = "quadrotor"
    acts_on = "torque"
    parameters = (Parameter("coefficient", "N·s", 3e-4, 0.0, 1.0),)
    needs = ("velocity", "rotor_speed")
    formula = "τ_x = +coefficient · (mean Ω / Ω_hover) · v_y, τ_y = −coefficient · (mean Ω / Ω_hover) · v_x"
    source = (
        "Hoffmann, Huang, Waslander & Tomlin 2007, Quadrotor helicopter flight dynamics and control, §III"
    )
    sentence = (
        "Flapping blades pitch the machine up against its motion: {coefficient} N·m for each m/s of in-plane "
        "airspeed at hover rotor speed; add the flapping moment to the simulator."
    )
    excitation = "fly straight lines forward and sideways at several speeds, holding the attitude at each"

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return roll and pitch torque, N·m."""
        gain = values["coefficient"] * rotor_speed_ratio(signals, constants)
        velocity = signals["velocity"]
        return {"torque_x": gain * velocity[..., 1], "torque_y": -gain * velocity[..., 0]}
