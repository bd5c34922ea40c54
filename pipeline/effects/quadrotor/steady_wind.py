"""Steady horizontal wind."""

import torch

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.physics import rotations
from simgap.physics.shapes import Channels


class SteadyWind(WrenchEffect):
    """A constant horizontal force acts in the world frame, at any heading."""

    # The wind acts through the drag of the frame, along all axes, and of the rotors, across their axis alone. The
    # share of the push along the rotor axis is therefore a parameter of its own.

    name = "steady_wind"
    kind = "quadrotor"
    acts_on = "force"
    parameters = (
        Parameter("push_x", "m/s²", 0.5, -10.0, 10.0),
        Parameter("push_y", "m/s²", 0.5, -10.0, 10.0),
        Parameter("axial_share", "1", 0.5, -0.5, 2.0, neutral=1.0),
    )
    linear = False
    needs = ("attitude",)
    formula = "a = diag(1, 1, axial_share) · attitude⁻¹ · (push_x, push_y, 0)"
    source = "Tomić, Schmid, Lutz, Mathers & Haddadin 2016, The flying anemometer: drag linear in relative airspeed"
    sentence = (
        "A steady wind pushes with {push_x} m/s² along world x and {push_y} m/s² along y, {axial_share} of it along "
        "the rotor axis; add it to the simulator (wind speed = push / drag coefficient)."
    )
    excitation = (
        "hover and turn on the spot, so that the push rotates in the body frame and the body's own forces do "
        "not"
    )
    symptom = "Hover needs a constant tilt towards one world direction, at any heading."
    look_alikes = ("body_drag", "rotor_drag")

    def starts(self) -> list[dict[str, float]]:
        """Start from the drag of a frame, and from that of rotors alone."""
        return [{**self.neutral(), "axial_share": share} for share in (1.0, 0.0)]

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the push in the body frame, m/s²."""
        attitude = signals["attitude"]
        one = torch.ones_like(attitude[..., 0])
        push = [values["push_x"] * one, values["push_y"] * one, 0.0 * one]
        world = torch.stack(push, dim=-1)
        across_x, across_y, along = rotations.rotate_inverse(attitude, world).unbind(-1)
        return {"force_x": across_x, "force_y": across_y, "force_z": values["axial_share"] * along}
