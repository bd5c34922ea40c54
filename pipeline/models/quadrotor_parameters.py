"""Identifiable rotor coefficients and inertia of a quadrotor.

Motion shows forces over mass and torques over inertia only. The mass and the rotor positions are taken from
the platform, which makes k_F, J_xx and J_yy observable; of k_M and J_zz the ratio alone is.

An estimate must not depend on the time scale of the averaging. If doubling the window changes it, the rotors' term has
absorbed something outside the equation, mostly the controller's response to an unmodelled torque. Such an estimate is
more wrong than its standard error says, and is withheld.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from simgap.models.parameters import WITHHELD, Parameter
from simgap.models.quadrotor_equations import quadrotor_tables
from simgap.models.regression import Table, fit_table, is_determined, jackknife_error
from simgap.models.settings import SystemIdentification
from simgap.platforms import Quadrotor
from simgap.recordings.recording import Recording

_EQUATIONS = {
    "thrust_coefficient": ("thrust",),
    "inertia_xx": ("thrust", "roll"),
    "inertia_yy": ("thrust", "pitch"),
    "torque_coefficient_over_inertia_zz": ("yaw",),
}
_MIXED_IN = "feedback or other physics biases the estimate"


@dataclass(frozen=True)
class QuadrotorParameters:
    """What was identified of a quadrotor.

    Attributes:
        parameters: by name; those that the recording cannot tell have no value, and a note that says why.
        explained: by equation, the share of the acceleration's variance that the fit explains.
    """

    parameters: dict[str, Parameter]
    explained: dict[str, float]


@dataclass(frozen=True)
class _Estimates:
    """Values by name, the same with each block left out, and what each equation explains."""

    value: dict[str, float]
    left_out: dict[str, np.ndarray]
    explained: dict[str, float]


def identify_quadrotor(
    recording: Recording, platform: Quadrotor, runs: Sequence[str], settings: SystemIdentification
) -> QuadrotorParameters:
    """Identify a quadrotor from some runs of a cleaned recording.

    Where no rotor speeds were recorded, commands stand for them; coefficients come times motor_speed_max².

    Raises:
        InputError: when no segment is as long as two windows.
    """
    commanded = "motor_speed_1" not in recording.units
    stem = "motor_command" if commanded else "motor_speed"
    near, far = (
        _estimate(quadrotor_tables(recording, platform, runs, stem, width, settings.block_duration), platform)
        for width in (settings.window, 2 * settings.window)
    )
    times = "_times_motor_speed_max_squared" if commanded else ""
    parameters = {
        name.replace("coefficient", f"coefficient{times}"): _fill(name, declared, near, far, settings)
        for name, declared in _declared(platform, commanded).items()
    }
    return QuadrotorParameters(parameters, near.explained)


def _declared(platform: Quadrotor, commanded: bool) -> dict[str, Parameter]:
    """Return every parameter with unit, nominal value and note, but without a value."""
    speed = platform.motor_speed_max**2 if commanded else 1.0
    per_speed = "" if commanded else "/(rad/s)²"
    force, torque = platform.thrust_coefficient * speed, platform.torque_coefficient * speed
    xx, yy, zz = platform.inertia
    given = "given the mass of the platform"
    geometry = f"{given} and its rotor positions; motion shows thrust_coefficient over inertia"
    alone = "not observable alone: motion shows torque_coefficient over inertia_zz"
    return {
        "thrust_coefficient": Parameter(None, f"N{per_speed}", nominal=force, note=given),
        "inertia_xx": Parameter(None, "kg·m²", nominal=xx, note=geometry),
        "inertia_yy": Parameter(None, "kg·m²", nominal=yy, note=geometry),
        "torque_coefficient_over_inertia_zz": Parameter(None, f"(rad/s²){per_speed}", nominal=torque / zz),
        "torque_coefficient": Parameter(None, f"N·m{per_speed}", nominal=torque, note=alone),
        "inertia_zz": Parameter(None, "kg·m²", nominal=zz, note=alone),
    }


def _estimate(tables: Mapping[str, Table], platform: Quadrotor) -> _Estimates:
    """Fit the four equations and combine their rotor terms; what the motion does not excite is left out."""
    fits = {name: fit_table(table) for name, table in tables.items() if is_determined(table.regressors)}
    slopes = {name: np.append(fit.left_out[:, 0], fit.coefficients[0]) for name, fit in fits.items()}
    found = {}
    if "thrust" in slopes:
        found["thrust_coefficient"] = platform.mass * slopes["thrust"]
        for axis, equation in (("xx", "roll"), ("yy", "pitch")):
            if equation in slopes:
                found[f"inertia_{axis}"] = found["thrust_coefficient"] / slopes[equation]
    if "yaw" in slopes:
        found["torque_coefficient_over_inertia_zz"] = slopes["yaw"]
    return _Estimates(
        value={name: float(values[-1]) for name, values in found.items()},
        left_out={name: values[:-1] for name, values in found.items()},
        explained={name: fit.explained for name, fit in fits.items()},
    )


def _fill(
    name: str, declared: Parameter, near: _Estimates, far: _Estimates, settings: SystemIdentification
) -> Parameter:
    """Give a parameter its value, or say why it has none."""
    if name not in _EQUATIONS:
        return declared
    if name not in near.value or name not in far.value:
        return replace(declared, note=f"{WITHHELD}the recorded motion does not excite it")
    value, other = near.value[name], far.value[name]
    explained = min(near.explained[equation] for equation in _EQUATIONS[name])
    if explained < settings.least_explained:
        note = f"{WITHHELD}its equations explain only {max(explained, 0.0):.0%} of the recorded acceleration"
        return replace(declared, note=note)
    error = float(jackknife_error(near.left_out[name]))
    if value <= 0.0:
        return replace(declared, note=f"{WITHHELD}{value:.3g} is not possible; {_MIXED_IN}")
    if abs(other - value) > settings.consistency * abs(value):
        note = (
            f"{WITHHELD}{value:.3g} from windows of {settings.window:g} s, {other:.3g} from twice as "
            f"long; {_MIXED_IN}"
        )
        return replace(declared, note=note)
    return replace(declared, value=value, standard_error=error)
