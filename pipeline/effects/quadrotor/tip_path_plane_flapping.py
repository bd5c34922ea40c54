"""Rotor discs that tilt in the airflow and lag behind the body.

This is one model level above `rotor_drag` and `blade_flapping_moment`. The tilt is the mean of the four discs.
Sideways tilts that depend on the rotors' direction of rotation cancel in pairs.
"""

from typing import Any

import torch
from torch import Tensor

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values, WrenchEffect
from simgap.effects.lag import lag_along_time, lag_step
from simgap.effects.quadrotor.common import rotor_speed_ratio, rotor_thrust
from simgap.effects.scan import scan
from simgap.physics.shapes import Channels, Signal

_SLOWEST_ROTOR = (
    0.1  # of the hover rotor speed; below, a rotor lifts a hundredth of the weight and its tilt has no effect
)


class TipPathPlaneFlapping(ActuatorEffect, WrenchEffect):
    """Rotor discs tilt in the airflow, follow the body with a lag, and tilt the thrust."""

    remembers = True
    linear = False
    order = 3
    names_physics = False
    name = "tip_path_plane_flapping"
    kind = "quadrotor"
    acts_on = "force"
    parameters = (
        Parameter("tilt", "rad·s/m", 0.03, 0.0, 1.0),
        Parameter("time_constant", "s", 0.01, 0.0, 0.2),
        Parameter("stiffness", "N·m/rad", 0.01, 0.0, 10.0),
    )
    needs = ("velocity", "body_rate", "rotor_speed")
    formula = (
        "with r = mean Ω / Ω_hover: dβ/dt = (tilt·v_xy / r − β)·r / time_constant + (ω_y, −ω_x); "
        "a_xy = −T/m · β, τ_x = (stiffness + Σ z_i·T_i)·β_y, τ_y = −(stiffness + Σ z_i·T_i)·β_x"
    )
    source = (
        "Leishman 2006, Principles of helicopter aerodynamics, §4.4–4.6 (time constant 16/(γΩ)); Kantue & Pedro, "
        "grey-box modelling of multirotors in aggressive manoeuvres"
    )
    sentence = (
        "The rotor discs tilt by {tilt} rad per m/s at hover rotor speed, lag by {time_constant} s, and twist"
        " the body by {stiffness} N·m per radian; add the tip path plane to the simulator."
    )
    excitation = "dash sideways and stop, and roll and pitch as fast as the machine can"
    symptom = "Lateral force and roll or pitch torque follow airspeed and body rate with a short lag."

    def starts(self) -> list[dict[str, float]]:
        """Start from a few sizes: without tilt the stiffness gives no gradient."""
        return scan(tilt=(0.01, 0.05), time_constant=(0.005, 0.05), stiffness=(0.01,))

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the mean tilt over the step, settled at the first; the memory holds the tilt at its end."""
        target, time_constant = _steady_tilt(signals, values, constants)
        start = target if memory is None else memory
        mean, end = lag_step(start, target, time_constant, time_step)
        return {"disc_tilt": mean}, end

    def along_time(
        self, signals: Signals, values: Values, constants: Values, time_step: float
    ) -> dict[str, Signal]:
        """Tilt the discs along whole blocks at once: the same as sample by sample."""
        target, time_constant = _steady_tilt(signals, values, constants)
        return {**signals, "disc_tilt": lag_along_time(target, time_constant, time_step)}

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return specific force, m/s², and torque, N·m."""
        thrust = rotor_thrust(signals, constants)
        back, side = signals["disc_tilt"].unbind(-1)
        heights = constants["rotor_positions"][:, 2].to(thrust)
        moment = values["stiffness"] + (heights * thrust).sum(-1)
        lift = thrust.sum(-1) / constants["mass"]
        return {
            "force_x": -lift * back,
            "force_y": -lift * side,
            "torque_x": moment * side,
            "torque_y": -moment * back,
        }


def _steady_tilt(signals: Signals, values: Values, constants: Values) -> tuple[Tensor, Tensor]:
    """Return the steady tilt (..., 2) of the discs away from +x and +y, rad, and the time constant, s."""
    ratio = rotor_speed_ratio(signals, constants).clamp_min(_SLOWEST_ROTOR)[..., None]
    time_constant = values["time_constant"] / ratio
    # The discs keep their plane in space while the body rotates.
    roll, pitch, _ = signals["body_rate"].unbind(-1)
    left_behind = torch.stack([pitch, -roll], dim=-1)
    return values["tilt"] * signals["velocity"][..., :2] / ratio + time_constant * left_behind, time_constant
