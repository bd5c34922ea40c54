"""Thrust that a rotor loses in climb."""

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.quadrotor.common import rotor_speed_ratio
from simgap.physics.shapes import Channels


class AxialInflow(WrenchEffect):
    """Thrust falls with the climb speed along the rotor axis."""

    name = "axial_inflow"
    kind = "quadrotor"
    acts_on = "force"
    prior_odds = 1.0  # every rotor loses thrust in climb
    parameters = (Parameter("coefficient", "1/s", 0.3, 0.0, 5.0),)
    needs = ("velocity", "rotor_speed")
    formula = "a_z = −coefficient · (mean Ω / Ω_hover) · v_z"
    source = (
        "Leishman 2006, Principles of helicopter aerodynamics, §3.2; linear in inflow as Kaufmann et al. 2023"
    )
    sentence = (
        "Each m/s of climb along the rotor axis costs {coefficient} m/s² at hover rotor speed; add axial "
        "inflow to the simulator."
    )
    excitation = "climb and descend at several speeds with little lateral motion"
    symptom = "Climbs need more rotor speed than the nominal model predicts, and descents need less."
    look_alikes = ("body_drag",)

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return specific force along body z, m/s²."""
        gain = -values["coefficient"] * rotor_speed_ratio(signals, constants)
        return {"force_z": gain * signals["velocity"][..., 2]}
