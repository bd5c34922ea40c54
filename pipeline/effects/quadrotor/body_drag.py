"""Parasitic drag of the airframe."""

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.quadrotor.common import along_axes
from simgap.physics.rotations import dot
from simgap.physics.shapes import Channels


class BodyDrag(WrenchEffect):
    """The drag of the airframe grows with the square of the airspeed, along the rotor axis perhaps more than across."""

    name = "body_drag"
    kind = "quadrotor"
    acts_on = "force"
    # A frame is no sphere: the air meets another face along the rotor axis than across.
    parameters = (
        Parameter("coefficient", "1/m", 0.03, 0.0, 2.0),
        Parameter("axial_excess", "1/m", 0.01, -2.0, 2.0, optional=True),
    )
    needs = ("velocity",)
    formula = "a = −|v| · diag(coefficient, coefficient, coefficient + axial_excess) · v"
    source = "Hoerner 1965, Fluid-dynamic drag, ch. 3; c = ρ·c_d·A/(2m)"
    sentence = (
        "The airframe's drag is {coefficient} m/s² at 1 m/s, {axial_excess} m/s² more along the rotor axis, and grows "
        "with airspeed squared; add body drag to the simulator."
    )
    excitation = (
        "fly straight lines at speeds a factor of three apart or more, and coast down from the fastest"
    )
    symptom = "Deceleration grows faster than in proportion to airspeed, at any rotor speed."
    look_alikes = ("rotor_drag",)

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return specific force along the airflow, m/s²."""
        velocity = signals["velocity"]
        speed = dot(velocity, velocity)[..., None].clamp_min(1e-12).sqrt()
        drag = along_axes("force", -values["coefficient"] * speed * velocity)
        axial = -values.get("axial_excess", 0.0) * speed[..., 0] * velocity[..., 2]
        return {**drag, "force_z": drag["force_z"] + axial}
