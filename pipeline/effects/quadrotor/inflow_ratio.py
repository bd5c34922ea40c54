"""Rotor thrust from blade-element and momentum theory.

This is one model level above `axial_inflow` and `translational_lift`, and it replaces both. Climb costs thrust,
sideways flight gains thrust, and both saturate. The direct gain from the blades' airspeed, of order (V/ΩR)², is left
out.
"""

import torch
from torch import Tensor

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.quadrotor.common import hover_rotor_speed
from simgap.effects.scan import scan
from simgap.physics.rotors import hub_velocity, wrench
from simgap.physics.shapes import Channels

_ITERATIONS = 20
_STILL = 1e-6  # m/s, taken as still air
_FOLD = (
    0.1  # of the blades' slope: in its own wake a rotor has no steady inflow, so the slope is bounded there
)


class InflowRatio(WrenchEffect):
    """Thrust changes with the inflow through each disc, from blade-element and momentum theory."""

    linear = False
    names_physics = False
    name = "inflow_ratio"
    kind = "quadrotor"
    acts_on = "force"
    parameters = (
        Parameter("sensitivity", "1", 1.5, 0.0, 10.0),
        Parameter("induced_velocity", "m/s", 6.0, 0.5, 40.0, neutral=5.0),
    )
    needs = ("velocity", "body_rate", "rotor_speed")
    formula = (
        "T / (k·Ω²) = 1 − sensitivity · ((v_z + u) / u_0 − 1) and = u·√(v_xy² + (v_z + u)²) / u_0², solved for u, with "
        "u_0 = induced_velocity · Ω / Ω_hover"
    )
    source = (
        "Leishman 2006, Principles of helicopter aerodynamics, §2.14 and §3.2 (sensitivity = solidity·lift slope / "
        "(8·inflow ratio)); Kantue & Pedro, grey-box modelling of multirotors in aggressive manoeuvres"
    )
    sentence = (
        "The thrust follows the inflow, {induced_velocity} m/s in hover, with a sensitivity of {sensitivity};"
        " solve for the inflow in the simulator."
    )
    excitation = "climb, descend and fly level at several speeds, and combine them"
    symptom = "Climbs lose thrust and level flight gains it, and both saturate at high speed."

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan: without sensitivity the induced velocity gives no gradient."""
        return scan(sensitivity=(0.5, 2.0), induced_velocity=(2.0, 5.0, 12.0))

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return specific force along body z, m/s², and the torque from differences between discs, N·m."""
        speed = signals["rotor_speed"]
        positions = constants["rotor_positions"].to(speed)
        hub = hub_velocity(signals["velocity"], signals["body_rate"], positions)
        hover = hover_rotor_speed(constants)
        still = values["induced_velocity"] * speed / hover
        crossing, climb = hub[..., :2].square().sum(-1), hub[..., 2]
        induced = _induced_velocity(still, crossing, climb, values["sensitivity"])
        excess = (climb + induced - still) * speed * hover / values["induced_velocity"]
        added = -constants["thrust_coefficient"] * values["sensitivity"] * excess
        force, torque = wrench(added, torch.zeros_like(added), positions)
        return {
            "force_z": force[..., 2] / constants["mass"],
            "torque_x": torque[..., 0],
            "torque_y": torque[..., 1],
        }


def _induced_velocity(still: Tensor, crossing: Tensor, climb: Tensor, sensitivity: Tensor | float) -> Tensor:
    """Return the induced velocity at which blade elements and momentum give the same thrust, m/s.

    Newton's method finds it without gradients; one last step adds the exact gradients.

    Args:
        still: induced velocity in still air at this rotor speed, m/s.
        crossing: square of the airspeed in the disc's plane, m²/s².
        climb: airspeed along the axis, m/s.
        sensitivity: of the thrust to the air through the disc.
    """
    sensitivity = torch.as_tensor(sensitivity, dtype=still.dtype, device=still.device)
    known = (still.detach(), crossing.detach(), climb.detach(), sensitivity.detach())
    induced, blades = known[0], known[3] * known[0] + _STILL
    for _ in range(_ITERATIONS):
        excess, slope = _disagreement(induced, *known)
        induced = induced - excess / slope.maximum(blades)
    _, slope = _disagreement(induced, *known)
    excess, _ = _disagreement(induced, still, crossing, climb, sensitivity)
    return induced - excess / slope.maximum(_FOLD * blades)


def _disagreement(
    induced: Tensor, still: Tensor, crossing: Tensor, climb: Tensor, sensitivity: Tensor
) -> tuple[Tensor, Tensor]:
    """Return the thrust by momentum less that by blade elements, over 2·density·area, m²/s², and its slope, m/s."""
    through = climb + induced
    resultant = (crossing + through.square() + _STILL**2).sqrt()
    blades = still * ((1.0 + sensitivity) * still - sensitivity * through)
    slope = sensitivity * still + resultant + induced * through / resultant
    return induced * resultant - blades, slope
