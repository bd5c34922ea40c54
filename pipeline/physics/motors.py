"""Direct-current motors and first-order lags (Krishnan, "Electric Motor Drives", chapter 2)."""

import torch

from simgap.physics.shapes import Real, Value


def current(voltage: Real, speed: Real, resistance: Value, back_emf_constant: Value) -> Real:
    """Return the current of a motor whose inductance is neglected, A.

    Args:
        voltage: at the terminals, V.
        speed: of the shaft, rad/s.
        resistance: of the winding, Ω.
        back_emf_constant: V/(rad/s); equals the torque constant in SI units.
    """
    return (voltage - back_emf_constant * speed) / resistance


def torque(motor_current: Real, torque_constant: Value) -> Real:
    """Return the torque at the shaft, N·m.

    Args:
        motor_current: A.
        torque_constant: N·m/A.
    """
    return torque_constant * motor_current


def first_order_lag(value: Real, target: Real, time_constant: Value, dt: float) -> Real:
    """Return the value dt later of d(value)/dt = (target − value) / time_constant, exact for a held target.

    Args:
        value: now, any unit.
        target: what it tends to, held over the step.
        time_constant: positive, s.
        dt: s.
    """
    decay = torch.exp(torch.as_tensor(-dt / time_constant, dtype=value.dtype, device=value.device))
    return target + (value - target) * decay
