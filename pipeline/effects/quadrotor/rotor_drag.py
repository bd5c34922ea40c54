"""Drag that spinning rotors feel when air moves through their plane."""

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.quadrotor.common import rotor_speed_ratio
from simgap.physics.shapes import Channels


class RotorDrag(WrenchEffect):
    """Lateral force opposing in-plane airspeed, growing with rotor speed (flapping and induced drag)."""

    name = "rotor_drag"
    kind = "quadrotor"
    acts_on = "force"
    parameters = (Parameter("coefficient", "1/s", 0.3, 0.0, 5.0),)
    needs = ("velocity", "rotor_speed")
    formula = "a_xy = −coefficient · (mean Ω / Ω_hover) · v_xy"
    source = "Martin & Salaün 2010, The true role of accelerometer feedback in quadrotor control, eq. 5"
    sentence = (
        "The rotors drag sideways through the air: at hover rotor speed each m/s of in-plane airspeed costs "
        "{coefficient} m/s² of lateral acceleration; add rotor drag to the simulator."
    )
    excitation = "fly straight lines forward and sideways at several speeds, holding the attitude at each"

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return lateral specific force, m/s²."""
        gain = -values["coefficient"] * rotor_speed_ratio(signals, constants)
        velocity = signals["velocity"]
        return {"force_x": gain * velocity[..., 0], "force_y": gain * velocity[..., 1]}
