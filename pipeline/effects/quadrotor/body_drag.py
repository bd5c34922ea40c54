"""Parasitic drag of the airframe."""

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.quadrotor.common import along_axes
from simgap.physics.shapes import Channels


class BodyDrag(WrenchEffect):
    """Drag quadratic in airspeed."""

    name = "body_drag"
    kind = "quadrotor"
    acts_on = "force"
    parameters = (Parameter("coefficient", "1/m", 0.03, 0.0, 2.0),)
    needs = ("velocity",)
    formula = "a = −coefficient · |v| · v"
    source = "Hoerner 1965, Fluid-dynamic drag, ch. 3; c = ρ·c_d·A/(2m)"
    sentence = (
        "The airframe drags through the air in proportion to airspeed squared: {coefficient} m/s² at 1 m/s, a "
        "hundred times that at 10 m/s; add quadratic body drag to the simulator."
    )
    excitation = (
        "fly straight lines at speeds at least a factor of three apart, and coast down from the fastest"
    )

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return specific force along the airflow, m/s²."""
        velocity = signals["velocity"]
        speed = velocity.square().sum(-1, keepdim=True).clamp_min(1e-12).sqrt()
        return along_axes("force", -values["coefficient"] * speed * velocity)
