"""Drag of spinning rotors in an in-plane airflow."""

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.quadrotor.common import rotor_speed_ratio
from simgap.physics.shapes import Channels


class RotorDrag(WrenchEffect):
    """A lateral force opposes in-plane airspeed and grows with rotor speed (flapping, induced drag)."""

    name = "rotor_drag"
    kind = "quadrotor"
    acts_on = "force"
    prior_odds = 1.0  # every rotor flaps or drags in a cross-flow
    parameters = (Parameter("coefficient", "1/s", 0.3, 0.0, 5.0),)
    needs = ("velocity", "rotor_speed")
    formula = "a_xy = −coefficient · (mean Ω / Ω_hover) · v_xy"
    source = "Martin & Salaün 2010, The true role of accelerometer feedback in quadrotor control, eq. 5"
    sentence = (
        "Each m/s of in-plane airspeed costs {coefficient} m/s² of lateral acceleration at hover rotor speed;"
        " add rotor drag to the simulator."
    )
    excitation = "fly straight lines forward and sideways at several speeds, and hold the attitude at each"
    symptom = "Lateral deceleration grows in proportion to airspeed and to rotor speed."

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return lateral specific force, m/s²."""
        gain = -values["coefficient"] * rotor_speed_ratio(signals, constants)
        velocity = signals["velocity"]
        return {"force_x": gain * velocity[..., 0], "force_y": gain * velocity[..., 1]}
