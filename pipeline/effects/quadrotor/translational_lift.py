"""Thrust that a rotor gains in an in-plane airflow."""

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.physics.shapes import Channels


class TranslationalLift(WrenchEffect):
    """Thrust grows with the square of the in-plane airspeed."""

    name = "translational_lift"
    kind = "quadrotor"
    acts_on = "force"
    parameters = (Parameter("coefficient", "1/m", 0.02, 0.0, 2.0),)
    needs = ("velocity",)
    formula = "a_z = +coefficient · (v_x² + v_y²)"
    source = "Kaufmann et al. 2023, Champion-level drone racing, Methods: term v_xy² of f_z"
    sentence = (
        "Thrust gains {coefficient} m/s² at 1 m/s of in-plane airspeed and grows with its square; add "
        "translational lift to the simulator."
    )
    excitation = "fly level straight lines at several speeds, and compare the thrust that holds the height"
    symptom = "Fast level flight needs less rotor speed to hold its height than the nominal model predicts."
    look_alikes = ("axial_inflow",)

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return specific force along body z, m/s²."""
        in_plane = signals["velocity"][..., :2].square().sum(-1)
        return {"force_z": values["coefficient"] * in_plane}
