"""Nominal mechanism of a joint: inertia, gravity, a spring, a lossless motor or a servo's position loop."""

import math
from collections.abc import Mapping
from typing import Any

import torch

from simgap.errors import InputError
from simgap.physics.servo import servo_effort
from simgap.physics.shapes import Channels, Real, Signal
from simgap.platforms.joint import GAINS, Joint
from simgap.platforms.mechanism import Channel, Constants, Mechanism, Signals


class JointMechanism(Mechanism):
    """One axis: I·a = effort − gravity_torque·sin(position) − stiffness·position.

    Signals: `position`, `velocity` and `effort` (at the joint), `voltage` (at the motor) or `position_command`; shape
    (...,).
    """

    kind = "joint"
    actuator_signals = ("effort", "voltage", "position_command")
    exerted = ("effort",)

    def __init__(self, platform: Joint, position_unit: str = "rad") -> None:
        self.platform = platform
        self.channels = (
            Channel("torque", "N·m", "torque") if position_unit == "rad" else Channel("force", "N", "force"),
        )

    def constants(self) -> dict[str, Any]:
        """Return inertia, load and motor of the platform."""
        platform, motor = self.platform, self.platform.motor
        constants = {
            "inertia": platform.inertia,
            "gravity_torque": platform.gravity_torque,
            "stiffness": platform.stiffness,
            "sliding_velocity": 0.01,
            "channel": self.channels[0].name,
        }
        if motor is not None:
            constants["resistance"] = motor.resistance
            constants["torque_constant"] = motor.torque_constant
            constants["gear_ratio"] = motor.gear_ratio
        return constants | self._loop()

    def _loop(self) -> dict[str, Any]:
        """Return the gains of the position loop that are known, and its limit."""
        controller = self.platform.controller
        if controller is None:
            return {}
        gains = {name: getattr(controller, name) for name in GAINS if name not in controller.unknown}
        limit = math.inf if controller.effort_limit is None else controller.effort_limit
        return {**gains, "effort_limit": limit, "given_gains": controller.given}

    def actuate(self, signals: Signals, constants: Constants) -> dict[str, Signal]:
        """Return the signals with the effort of the motor at a voltage, or of a servo's loop, unless effort is given.

        Raises:
            InputError: when a servo is told a position and its gains are unknown.
        """
        if "position_command" in signals:
            if not {*GAINS} <= constants.keys():
                remedy = "give proportional and derivative, or diagnose a recording, which identifies them"
                raise InputError("the gains of the position loop are unknown", "platform.controller", remedy)
            error = signals["position_command"] - signals["position"]
            return {**signals, "effort": servo_effort(error, signals["velocity"], constants)}
        if "voltage" not in signals:
            return dict(signals)
        constant = constants["torque_constant"] * constants["gear_ratio"]
        current = (signals["voltage"] - constant * signals["velocity"]) / constants["resistance"]
        return {**signals, "effort": constant * current}

    def wrench(self, signals: Signals, constants: Constants) -> Channels:
        """Effort less gravity and spring."""
        position = signals["position"]
        load = constants["gravity_torque"] * torch.sin(position) + constants["stiffness"] * position
        return {self.channels[0].name: signals["effort"] - load}

    def loads(self, wrench: Mapping[str, Real], signals: Signals) -> dict[str, Signal]:
        """All that acts on the axis."""
        return {"axis_load": wrench[self.channels[0].name]}

    def free_inertia(self, signals: Signals) -> Channels:
        """The motor's share while it crosses backlash."""
        return {self.channels[0].name: signals["free_inertia"]} if "free_inertia" in signals else {}

    def inertial(self, signals: Signals, constants: Constants) -> Channels:
        """Nothing: the frame of an axis does not turn."""
        return {}

    def momentum(self, signals: Signals, constants: Constants) -> Channels:
        """Inertia times velocity."""
        return {self.channels[0].name: constants["inertia"] * signals["velocity"]}

    def inertia(self, constants: Constants) -> dict[str, float]:
        """The inertia of the axis."""
        return {self.channels[0].name: float(constants["inertia"])}

    def damping(self, constants: Constants) -> dict[str, float]:
        """The back-EMF brakes the axis where a voltage drives it."""
        if "torque_constant" not in constants:
            return {}
        gain = float(constants["torque_constant"]) * float(constants["gear_ratio"])
        rate = gain**2 / (float(constants["resistance"]) * float(constants["inertia"]))
        return {self.channels[0].name: rate}
