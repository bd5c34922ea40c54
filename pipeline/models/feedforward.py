"""The DC motor's feedforward V = kS·sign(v) + kV·v + kA·dv/dt from voltage and speed, with the loads of a joint.

Gravity adds kG·sin(position), a spring kSpring·position, where the platform file tells of them.

The constants come from the law itself in weak form: averaged over windows with the acceleration integrated by
parts, so that neither noise nor an uneven clock is differentiated. Beside them a ridge regression predicts
the speed at the next sample from [sign(v), V, v, a], a being the backward difference: how well it does on
data it was not fitted on says how linear the motor is. Where speeds are noiseless its constants are the same:
with v′ = c_s·sign(v) + c_V·V + c_v·v + c_a·a, equilibrium gives kS = −c_s/c_V and kV = (1 − c_v)/c_V, and the
dominant root z of z² − (c_v + c_a/T)·z + c_a/T = 0 gives kA = −kV·T/ln z. Noise draws c_v towards zero and
with it kA; the weak form hardly notices. Regressors are scaled to unit mean square but not centred: the law
has no constant term. Source: WPILib, "System Identification", whose constants these are.
"""

from dataclasses import dataclass

import numpy as np
import torch

from simgap.models.motor_samples import MotorSamples, with_acting_voltage
from simgap.models.parameters import WITHHELD, Parameter
from simgap.models.regression import Table, fit_table, is_determined, jackknife_error, join
from simgap.models.settings import SystemIdentification
from simgap.physics.weak_form import moving_centres, moving_mean_of, moving_mean_rate_of, moving_window

_HELD_OUT_SHARE = 0.2


@dataclass(frozen=True)
class Feedforward:
    """What was identified of one motor.

    Attributes:
        parameters: kS in V, kV in V per speed, kA in V per acceleration, with standard errors.
        scores: MSE, MAE and R² of the next speed on the blocks that were not fitted; number of samples.
    """

    parameters: dict[str, Parameter]
    scores: dict[str, float]


def identify_feedforward(
    motor: MotorSamples, settings: SystemIdentification, nominal: dict[str, float], seed: int = 0
) -> Feedforward:
    """Identify one motor.

    Args:
        motor: its samples.
        settings: of the identification.
        nominal: kS, kV, kA as the platform has them, where it does.
        seed: of the draw of the blocks that score the regression.
    """
    motor = with_acting_voltage(motor)
    threshold = settings.motion_threshold * max(np.percentile(np.abs(v), 99) for v in motor.velocity)
    numbers = motor.blocks(settings.block_duration)
    balance = _voltage_balance(motor, numbers, threshold, settings.window)
    units = _units(motor)
    if not is_determined(balance.regressors):
        note = f"{WITHHELD}the motion does not excite all parameters"
        unknown = {
            name: Parameter(None, unit, nominal=nominal.get(name), note=note) for name, unit in units.items()
        }
        return Feedforward(unknown, {})
    fit = fit_table(balance)
    errors = jackknife_error(fit.left_out)
    following = _next_speed(motor, numbers, threshold)
    one_step = constants_of(fit_table(following, settings.ridge).coefficients[:4], motor.time_step)
    checks = [*one_step, *[np.nan] * len(motor.loads)]
    parameters = {
        name: _parameter(name, float(value), float(error), unit, nominal.get(name), float(check))
        for (name, unit), value, error, check in zip(
            units.items(), fit.coefficients, errors, checks, strict=True
        )
    }
    return Feedforward(parameters, _scores(following, settings.ridge, seed))


def _units(motor: MotorSamples) -> dict[str, str]:
    units = {"kS": "V", "kV": f"V/({motor.speed_unit})", "kA": f"V/({motor.speed_unit}²)"}
    length = motor.speed_unit.removesuffix("/s")
    return units | {name: f"V/{length}" if name == "kSpring" else "V" for name in motor.loads}


def _parameter(
    name: str, value: float, error: float, unit: str, nominal: float | None, check: float
) -> Parameter:
    """Return a gain; no motor has a negative kV or kA, so that such a one is not told by the recording."""
    if name in ("kV", "kA") and value <= 0.0:
        note = f"{WITHHELD}it comes out as {value:.3g}; drive harder, with longer steps and fewer reversals"
        return Parameter(None, unit, nominal=nominal, note=note)
    return Parameter(value, unit, error, nominal, _note(check))


def constants_of(coefficients: np.ndarray, time_step: float) -> np.ndarray:
    """Return [kS, kV, kA] (..., 3) of one-step regressions; kA is NaN where nothing decays.

    Args:
        coefficients: c_s, c_V, c_v, c_a of sign(v), V, v, a, (..., 4).
        time_step: s.
    """
    sign, voltage, velocity, acceleration = np.moveaxis(coefficients, -1, 0)
    memory = acceleration / time_step
    half = (velocity + memory) / 2
    with np.errstate(invalid="ignore", divide="ignore"):
        static, speed = -sign / voltage, (1 - velocity) / voltage
        root = half + np.sqrt(half**2 - memory)
        inertia = np.where((root > 0) & (root < 1), -speed * time_step / np.log(root), np.nan)
    return np.stack([static, speed, inertia], axis=-1)


def _voltage_balance(
    motor: MotorSamples, numbers: list[np.ndarray], threshold: float, window: float
) -> Table:
    """Return the law in weak form: means of sign(v), v, dv/dt and loads against those of V, over moving windows."""
    function = moving_window(window, motor.time_step)
    pieces = []
    for voltage, velocity, number, *loads in zip(
        motor.voltage, motor.velocity, numbers, *motor.loads.values(), strict=True
    ):
        # Held from its sample to the next: around a sample acts the mean of this voltage and the one before.
        held = 0.5 * (voltage + np.concatenate([voltage[:1], voltage[:-1]]))
        in_motion = np.abs(velocity) > threshold
        series = torch.from_numpy(np.stack([np.sign(velocity), velocity, held, in_motion, *loads]))
        sign, speed, target, share, *taken = moving_mean_of(function, series).numpy()
        acceleration = moving_mean_rate_of(function, series[1]).numpy()
        moving = share > 1.0 - 1e-9
        centres = moving_centres(function, len(number)).numpy()
        regressors = np.column_stack([sign, speed, acceleration, *taken])
        pieces.append((regressors[moving], target[moving], number[centres][moving]))
    return join(pieces)


def _next_speed(motor: MotorSamples, numbers: list[np.ndarray], threshold: float) -> Table:
    """Return sign(v), V, v, a and loads against the next speed, at every sample in motion."""
    pieces = []
    for voltage, velocity, number, *loads in zip(
        motor.voltage, motor.velocity, numbers, *motor.loads.values(), strict=True
    ):
        now = velocity[1:-1]
        backward = np.diff(velocity)[:-1] / motor.time_step
        moving = np.abs(now) > threshold
        taken = [load[1:-1] for load in loads]
        table = np.column_stack([np.sign(now), voltage[1:-1], now, backward, *taken])
        pieces.append((table[moving], velocity[2:][moving], number[1:-1][moving]))
    return join(pieces)


def _note(check: float) -> str:
    return f"the one-step regression gives {check:.4g}" if np.isfinite(check) else ""


def _scores(table: Table, ridge: float, seed: int) -> dict[str, float]:
    """Score the one-step regression, fitted on four fifths of the blocks, by the others."""
    count = int(table.block.max()) + 1
    held_out = np.random.default_rng(seed).permutation(count)[: max(round(_HELD_OUT_SHARE * count), 1)]
    test = np.isin(table.block, held_out)
    if test.all():
        return {}
    fit = fit_table(table.take(~test), ridge)
    target = table.target[test]
    residual = target - table.regressors[test] @ fit.coefficients
    error = float(np.mean(residual**2))
    return {
        "mse": error,
        "mae": float(np.mean(np.abs(residual))),
        "r2": 1.0 - error / max(float(np.var(target)), np.finfo(float).tiny),
        "samples": len(table.target),
    }
