"""Position controller of a joint, based on the platform file alone."""

import numpy as np

from simgap.plants.joint.case import JointCase
from simgap.plants.rotation import Array
from simgap.plants.sampling import quantised
from simgap.platforms import Joint

_DAMPING_RATIO = 0.8
_RESERVE = 4.0  # times what the reference needs: no drive pushes harder, and no loop runs away
_DIFFERENTIATOR = 400.0  # rad/s, cut-off of the filter that makes a velocity of encoder positions


class JointController:
    """Feedforward by the nominal equations, proportional and derivative feedback of the encoder."""

    def __init__(
        self, platform: Joint, case: JointCase, position: Array, velocity: Array, step: float
    ) -> None:
        """Start at a position and velocity (runs,), to be asked for a command every step, s."""
        self.platform, self.case = platform, case
        motor = platform.motor
        self.constant = motor.torque_constant * motor.gear_ratio if motor else 0.0
        self.share = 1.0 - np.exp(-_DIFFERENTIATOR * step)
        self.gain = _DIFFERENTIATOR
        self.smooth = position - velocity / self.gain
        needed = platform.inertia * case.acceleration + platform.stiffness * case.amplitude
        self.most = _RESERVE * (needed + platform.gravity_torque)
        self.step = case.sensors.scale * case.sensors.position_step

    def command(self, reference: tuple[Array, Array, Array], position: Array) -> Array:
        """Return the voltage, V, or effort, N·m or N, (runs,).

        Args:
            reference: position, velocity and acceleration (runs,).
            position: with the encoder's noise, (runs,).
        """
        platform, bandwidth = self.platform, self.case.bandwidth
        seen = quantised(position, self.step)
        self.smooth = self.smooth + self.share * (seen - self.smooth)
        velocity = self.gain * (seen - self.smooth)
        target, speed, pace = reference
        wanted = pace + 2.0 * _DAMPING_RATIO * bandwidth * (speed - velocity)
        wanted = wanted + bandwidth * bandwidth * (target - seen)
        effort = platform.inertia * wanted + platform.stiffness * target
        if platform.gravity_torque:
            effort = effort + platform.gravity_torque * np.sin(target)
        if platform.motor is None:
            return np.clip(effort, -self.most, self.most)
        voltage = platform.motor.resistance / self.constant * effort + self.constant * speed
        return np.clip(voltage, -self.case.supply, self.case.supply)
