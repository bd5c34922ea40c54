"""Rotor discs that tilt in the airflow and lag behind the body.

This is one model level above `rotor_drag` and `blade_flapping_moment`. Each disc has a tilt of its own, from the
velocity of its hub and the inflow through it. Sideways tilts that depend on the rotors' direction of rotation cancel in
pairs.
"""

from typing import Any

import torch
from torch import Tensor

from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values, WrenchEffect
from simgap.effects.lag import lag_along_time, lag_step
from simgap.effects.quadrotor.common import hover_rotor_speed, rotor_thrust
from simgap.effects.scan import scan
from simgap.physics.induced_velocity import induced_velocity
from simgap.physics.rotors import hub_velocity
from simgap.physics.shapes import Channels, Signal

_SLOWEST_ROTOR = (
    0.1  # of the hover rotor speed; below, a rotor lifts a hundredth of the weight and its tilt has no effect
)


class TipPathPlaneFlapping(ActuatorEffect, WrenchEffect):
    """Rotor discs tilt in the airflow, the less the more flows through them, lag the body, and tilt the thrust."""

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
        Parameter("inflow", "1", 0.4, 0.0, 3.0, optional=True),
        Parameter("induced_velocity", "m/s", 6.0, 0.5, 40.0, neutral=5.0, optional=True),
    )
    needs = ("velocity", "body_rate", "rotor_speed")
    formula = (
        "each disc at its hub's velocity v, with r = Ω / Ω_hover and u_0 = induced_velocity·r: "
        "dβ/dt = (tilt·v_xy / r · (1 − inflow·((v_z + u) / u_0 − 1)) − β)·r / time_constant + (ω_y, −ω_x), "
        "u·√(v_xy² + (v_z + u)²) = u_0²; a_xy = −Σ T_i·β_i / m, τ_x = Σ (stiffness/4 + z_i·T_i)·β_y,i, "
        "τ_y = −Σ (stiffness/4 + z_i·T_i)·β_x,i, τ_z = Σ T_i·(y_i·β_x,i − x_i·β_y,i)"
    )
    source = (
        "Leishman 2006, Principles of helicopter aerodynamics, §2.14 and §4.4–4.6 (time constant 16/(γΩ), "
        "tilt = (8/3·pitch − 2λ)/(ΩR) and inflow = 2λ/(8/3·pitch − 2λ) with the inflow ratio λ in hover); Kantue & "
        "Pedro, grey-box modelling of multirotors in aggressive manoeuvres"
    )
    sentence = (
        "The rotor discs tilt by {tilt} rad per m/s at hover rotor speed, lag by {time_constant} s, and twist"
        " the body by {stiffness} N·m per radian; add the tip path plane to the simulator."
    )
    excitation = "dash sideways and stop, and roll and pitch as fast as the machine can"
    symptom = "Lateral force and roll or pitch torque follow airspeed and body rate with a short lag."

    def starts(self) -> list[dict[str, float]]:
        """Start from a few sizes: without tilt the stiffness gives no gradient."""
        first = {"stiffness": (0.01,), "inflow": (0.3,), "induced_velocity": (5.0,)}
        return scan(tilt=(0.01, 0.05), time_constant=(0.005, 0.05), **first)

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the discs' mean tilt over the step, settled at the first; the memory holds the tilt at its end."""
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
        positions = constants["rotor_positions"].to(thrust)
        moment = 0.25 * values["stiffness"] + positions[:, 2] * thrust
        return {
            "force_x": -(thrust * back).sum(-1) / constants["mass"],
            "force_y": -(thrust * side).sum(-1) / constants["mass"],
            "torque_x": (moment * side).sum(-1),
            "torque_y": -(moment * back).sum(-1),
            "torque_z": (thrust * (positions[:, 1] * back - positions[:, 0] * side)).sum(-1),
        }


def _steady_tilt(signals: Signals, values: Values, constants: Values) -> tuple[Tensor, Tensor]:
    """Return the steady tilt (..., 4, 2) of the discs away from +x and +y, rad, and time constants (..., 4, 1), s."""
    speed, rate = signals["rotor_speed"], signals["body_rate"]
    ratio = (speed / hover_rotor_speed(constants)).clamp_min(_SLOWEST_ROTOR)
    hub = hub_velocity(signals["velocity"], rate, constants["rotor_positions"].to(speed))
    still, climb = values["induced_velocity"] * ratio, hub[..., 2]
    induced = induced_velocity(still, hub[..., :2].square().sum(-1), climb, 0.0)
    tilt = values["tilt"] / ratio * (1.0 - values["inflow"] * ((climb + induced) / still - 1.0))
    time_constant = (values["time_constant"] / ratio)[..., None]
    # The discs keep their plane in space while the body rotates.
    left_behind = torch.stack([rate[..., 1], -rate[..., 0]], dim=-1)[..., None, :]
    return tilt[..., None] * hub[..., :2] + time_constant * left_behind, time_constant
