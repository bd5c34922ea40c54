"""Hub moment of rotors whose discs tilt in the airflow."""

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.quadrotor.common import rotor_speed_ratio
from simgap.physics.shapes import Channels


class BladeFlappingMoment(WrenchEffect):
    """A roll or pitch torque grows with in-plane airspeed and lifts the side that meets the air."""

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
        "Flapping pitches the machine up by {coefficient} N·m per m/s of in-plane airspeed at hover rotor "
        "speed; add this moment to the simulator."
    )
    excitation = "fly straight lines forward and sideways at several speeds, and hold the attitude at each"
    symptom = "Steady forward flight needs a nose-down torque that grows with the airspeed."
    look_alikes = ("center_of_mass_offset",)

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return roll and pitch torque, N·m."""
        gain = values["coefficient"] * rotor_speed_ratio(signals, constants)
        velocity = signals["velocity"]
        return {"torque_x": gain * velocity[..., 1], "torque_y": -gain * velocity[..., 0]}
