"""A servo that is told a position: its own encoder, its loop, its limit, and the drive behind it.

Richer than the law of a diagnosis: it sees its position in steps, differentiates it through a filter, is a step late,
and its current takes a moment to build up. What of these is within what a log resolves has no name.
"""

from dataclasses import dataclass

import numpy as np

from simgap.plants.concealment import Concealed
from simgap.plants.joint.case import JointCase
from simgap.plants.joint.drive import Drive, drive_of
from simgap.plants.rotation import Array
from simgap.plants.sampling import quantised
from simgap.platforms import Joint

_DIFFERENTIATOR = 1500.0  # rad/s, cut-off of the filter that makes a velocity of encoder positions
_CURRENT_LOOP = 3e-4  # s, time constant of the current


@dataclass
class Servo:
    """The servo of one axis, with the loop closed at every call.

    Attributes:
        proportional: true, N·m/rad or N/m.
        derivative: true, N·m·s/rad or N·s/m.
        limit: of the effort, N·m or N.
        scale: by which the position that it goes for is greater than the one that it is told.
        dead_zone: half width in the error, rad or m.
        encoder: its step, rad or m.
        drive: what the effort passes on its way to the axis.
        smooth: state of the differentiator, (runs,) rad or m; None before the first call.
        rate: what it last gave, (runs,) rad/s or m/s.
        pushed: state of the current loop, (runs,) N·m or N.
    """

    proportional: float
    derivative: float
    limit: float
    scale: float
    dead_zone: float
    encoder: float
    drive: Drive
    smooth: Array | None = None
    rate: Array | None = None
    pushed: Array | None = None

    def effort(self, command: Array, position: Array, velocity: Array, step: float) -> Array:
        """Return the effort at the joint (runs,), N·m or N.

        Args:
            command: position that has arrived, rad or m.
            position: of the load, where such servos have their encoder.
            velocity: of the motor in the joint's terms, rad/s or m/s.
            step: since the last call, s; 0 to look without letting time pass.
        """
        seen = quantised(position, self.encoder)
        rate = self._differentiated(seen, velocity, step)
        error = self.scale * command - seen
        error = error - np.clip(error, -self.dead_zone, self.dead_zone)
        asked = np.clip(self.proportional * error - self.derivative * rate, -self.limit, self.limit)
        before = asked if self.pushed is None else self.pushed
        self.pushed = asked + (before - asked) * np.exp(-step / _CURRENT_LOOP)
        return self.drive.effort(self.pushed, velocity, step)

    def _differentiated(self, seen: Array, velocity: Array, step: float) -> Array:
        """Return the filtered slope of the encoder's positions (runs,); of a ramp it is exact once settled."""
        if self.smooth is None or self.rate is None:
            self.smooth, self.rate = seen - velocity / _DIFFERENTIATOR, velocity
        if step > 0:
            share = 1.0 - np.exp(-_DIFFERENTIATOR * step)
            self.rate = share / step * (seen - self.smooth)
            self.smooth = self.smooth + share * (seen - self.smooth)
        return self.rate


def servo_of(effects: Concealed, platform: Joint, case: JointCase, random: np.random.Generator) -> Servo:
    """Return the servo that a case conceals, before its first step."""
    controller = platform.controller
    assert controller is not None  # the case was checked
    assert controller.proportional is not None
    assert controller.derivative is not None
    proportional = controller.proportional * effects.get("controller_gain_error", "proportional")
    given = np.inf if controller.effort_limit is None else controller.effort_limit
    drive = drive_of(effects, platform, case, random)
    scale, drive.scale = drive.scale, 1.0
    width, drive.dead_zone = drive.dead_zone, 0.0
    return Servo(
        proportional=proportional,
        derivative=controller.derivative * effects.get("controller_gain_error", "derivative"),
        limit=min(given, effects.get("effort_limit", "limit")),
        scale=scale,
        dead_zone=width / proportional,
        encoder=case.sensors.scale * case.sensors.position_step,
        drive=drive,
    )
