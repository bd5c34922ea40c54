"""Steady horizontal wind."""

import torch
from torch import Tensor

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.quadrotor.common import along_axes
from simgap.physics import rotations
from simgap.physics.shapes import Channels

_WEAKEST = 1e-9
"""Push that is none, m/s²: it keeps the law smooth there."""
_NOTHING = 1e-24


class SteadyWind(WrenchEffect):
    """A constant horizontal wind pushes at any heading, the less the faster the machine flies with it."""

    # Drag that is linear in airspeed makes a wind a constant push. Quadratic drag does not: what the wind adds to the
    # drag in still air depends on how fast the machine flies. The wind also acts through the drag of the frame along
    # all axes and through that of the rotors across their axis alone.

    name = "steady_wind"
    kind = "quadrotor"
    acts_on = "force"
    parameters = (
        Parameter("push_x", "m/s²", 0.5, -10.0, 10.0),
        Parameter("push_y", "m/s²", 0.5, -10.0, 10.0),
        Parameter("axial_share", "1", 0.5, -0.5, 2.0, neutral=1.0),
        Parameter("slowness", "s/m", 0.2, 0.0, 2.0, optional=True),
    )
    linear = False
    needs = ("attitude", "velocity")
    formula = (
        "a = diag(1, 1, axial_share) · |p| · (|e − s·v|·(e − s·v) + s²·|v|·v), p = attitude⁻¹ · (push_x, push_y, 0), "
        "e = p/|p|, s = slowness"
    )
    source = (
        "Tomić, Schmid, Lutz, Mathers & Haddadin 2016, The flying anemometer: drag linear in relative airspeed "
        "(slowness 0); Hoerner 1965, Fluid-dynamic drag, ch. 3: quadratic, 1/slowness is then the speed of the wind"
    )
    sentence = (
        "A steady wind pushes with {push_x} m/s² along world x and {push_y} m/s² along y, {axial_share} of it along "
        "the rotor axis, at {slowness} s/m; add it to the simulator (wind speed = push / drag coefficient)."
    )
    excitation = (
        "hover and turn on the spot, so that the push rotates in the body frame and the body's own forces do "
        "not"
    )
    symptom = "Hover needs a constant tilt towards one world direction, at any heading."
    look_alikes = ("body_drag", "rotor_drag")

    def starts(self) -> list[dict[str, float]]:
        """Start from the quadratic drag of a frame in some wind, and from the linear drag of frame or rotors."""
        still = self.neutral()
        blown = {**still, "push_x": 0.1, "slowness": 0.1}  # without a push its direction has no slope
        return [blown, still, {**still, "axial_share": 0.0}]

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return what the wind adds to the drag in still air, body frame, m/s²."""
        attitude, velocity = signals["attitude"], signals["velocity"]
        one = torch.ones_like(attitude[..., 0])
        push = torch.stack([values["push_x"] * one, values["push_y"] * one, 0.0 * one], dim=-1)
        push = rotations.rotate_inverse(attitude, push)
        flown = values.get("slowness", 0.0) * velocity
        strength = _length(push, _WEAKEST)
        relative = push / strength - flown
        # The second term is 0 but for a push of nothing, whose direction is unknown.
        speed = (rotations.dot(relative, relative)[..., None] + (_WEAKEST / strength) ** 2).sqrt()
        added = strength * (speed * relative + _length(flown, 0.0) * flown)
        share = torch.stack([one, one, values["axial_share"] * one], dim=-1)
        return along_axes("force", share * added)


def _length(vectors: Tensor, least: float) -> Tensor:
    """Return the length of vectors (..., 3) and of a least one at right angles, (..., 1)."""
    return (rotations.dot(vectors, vectors)[..., None] + least**2).clamp_min(_NOTHING).sqrt()
