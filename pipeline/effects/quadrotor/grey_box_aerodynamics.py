"""Aerodynamics of a racing quadrotor as polynomials with one coefficient per term."""

from typing import ClassVar

import torch
from torch import Tensor

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.quadrotor.common import hover_rotor_speed
from simgap.physics.shapes import Channels

# (name, unit, default, bound on the size); in the order of the terms that `_terms` returns.
_LATERAL = (
    ("linear_{axis}_drag", "1/s", -0.15, 5.0),
    ("quadratic_{axis}_drag", "1/m", -0.015, 2.0),
    ("thrust_tilt_{axis}", "m/s²", 0.05, 5.0),
    ("rotor_{axis}_drag", "1/s", -0.15, 5.0),
)
_VERTICAL = (
    ("linear_climb", "1/s", -0.1, 5.0),
    ("quadratic_climb", "1/m", -0.02, 2.0),
    ("linear_lift", "1/s", 0.1, 5.0),
    ("quadratic_lift", "1/m", 0.01, 2.0),
    ("rotor_lift", "1/s", 0.1, 5.0),
    ("rotor_climb", "1/s", -0.3, 5.0),
    ("rotor_lift_climb", "1/m", -0.01, 2.0),
)
_ROLL_AND_PITCH = (
    ("linear_{axis}_moment", "N·s", 2e-4, 1.0),
    ("quadratic_{axis}_moment", "N·s²/m", 2e-5, 1.0),
    ("thrust_offset_{other}", "N·m", 5e-3, 5.0),
    ("rotor_{axis}_moment", "N·s", 2e-4, 1.0),
    ("rotor_quadratic_{axis}_moment", "N·s²/m", 2e-5, 1.0),
)
_YAW = (("drag_offset_y", "N·s", 1e-4, 1.0), ("drag_offset_x", "N·s", 1e-4, 1.0))


def _named(terms: tuple[tuple[str, str, float, float], ...], axis: str, other: str) -> tuple[Parameter, ...]:
    return tuple(
        Parameter(name.format(axis=axis, other=other), unit, default, -bound, bound)
        for name, unit, default, bound in terms
    )


_CHANNELS = {
    "force_x": _named(_LATERAL, "x", "y"),
    "force_y": _named(_LATERAL, "y", "x"),
    "force_z": _named(_VERTICAL, "z", "z"),
    "torque_x": _named(_ROLL_AND_PITCH, "roll", "y"),
    "torque_y": _named(_ROLL_AND_PITCH, "pitch", "x"),
    "torque_z": _named(_YAW, "z", "z"),
}


class GreyBoxAerodynamics(WrenchEffect):
    """Aerodynamic forces and torques are polynomials with coefficients fitted to flights."""

    name = "grey_box_aerodynamics"
    kind = "quadrotor"
    acts_on = "force"
    names_physics: ClassVar[bool] = False
    parameters = tuple(parameter for named in _CHANNELS.values() for parameter in named)
    needs = ("velocity", "rotor_speed")
    formula = (
        "with w = mean(Ω²) / Ω_hover², v_h = |v_xy|: "
        "f_x = linear_x_drag·v_x + quadratic_x_drag·v_x|v_x| + thrust_tilt_x·w + rotor_x_drag·w·v_x; "
        "f_y = linear_y_drag·v_y + quadratic_y_drag·v_y|v_y| + thrust_tilt_y·w + rotor_y_drag·w·v_y; "
        "f_z = linear_climb·v_z + quadratic_climb·v_z|v_z| + linear_lift·v_h + quadratic_lift·v_h² + rotor_lift·w·v_h "
        "+ rotor_climb·w·v_z + rotor_lift_climb·w·v_h·v_z; "
        "τ_x = linear_roll_moment·v_y + quadratic_roll_moment·v_y|v_y| + thrust_offset_y·w + rotor_roll_moment·w·v_y "
        "+ rotor_quadratic_roll_moment·w·v_y|v_y|; "
        "τ_y = linear_pitch_moment·v_x + quadratic_pitch_moment·v_x|v_x| + thrust_offset_x·w "
        "+ rotor_pitch_moment·w·v_x + rotor_quadratic_pitch_moment·w·v_x|v_x|; "
        "τ_z = drag_offset_y·v_x + drag_offset_x·v_y"
    )
    source = "Kaufmann et al. 2023, Champion-level drone racing using deep reinforcement learning, Methods"
    sentence = (
        "The aerodynamics are polynomials of airspeed and rotor speed fitted to flights ({linear_x_drag} m/s²"
        " along x per m/s, and so on); use them in the simulator."
    )
    excitation = "race in every direction, at every speed and every thrust that the policy will meet"
    symptom = "Residual forces and torques depend on airspeed and rotor speed about every axis."

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return specific force, m/s², and torque, N·m."""
        terms = _terms(signals, constants)
        return {
            channel: torch.stack(
                [values[parameter.name] * term for parameter, term in zip(named, terms[channel], strict=True)]
            ).sum(0)
            for channel, named in _CHANNELS.items()
        }


def _terms(signals: Signals, constants: Values) -> dict[str, list[Tensor]]:
    """Return the terms of each channel, in the order of its coefficients."""
    x, y, z = signals["velocity"].unbind(-1)
    load = signals["rotor_speed"].square().mean(-1) / hover_rotor_speed(constants) ** 2
    level = (x.square() + y.square()).clamp_min(1e-24).sqrt()
    return {
        "force_x": [x, x * x.abs(), load, load * x],
        "force_y": [y, y * y.abs(), load, load * y],
        "force_z": [z, z * z.abs(), level, level**2, load * level, load * z, load * level * z],
        "torque_x": [y, y * y.abs(), load, load * y, load * y * y.abs()],
        "torque_y": [x, x * x.abs(), load, load * x, load * x * x.abs()],
        "torque_z": [x, y],
    }
