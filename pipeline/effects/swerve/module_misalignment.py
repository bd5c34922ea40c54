"""Modules of a swerve drive whose encoder zero is not straight ahead."""

import itertools
from typing import Any

import torch
from torch import Tensor

from simgap.effects.effect import ConstantEffect, Parameter, Signals, Values, WrenchEffect
from simgap.effects.swerve.common import on_chassis
from simgap.physics.shapes import Channels
from simgap.platforms.swerve_constraint import along_the_wheels
from simgap.platforms.swerve_kinematics import lateral_matrix, rolling_speed

_OFFSETS = tuple(f"offset_{module}" for module in range(1, 5))
_STANDS_OUT = 2.0  # times the next offset, from which on one module is to blame; a choice of words, no test


class ModuleMisalignment(ConstantEffect, WrenchEffect):
    """Each wheel points away from its encoder reading, so the wheels work against each other."""

    linear = False
    name = "module_misalignment"
    kind = "swerve"
    acts_on = "chassis"
    parameters = (
        *(Parameter(offset, "rad", 0.05, -0.8, 0.8) for offset in _OFFSETS),
        Parameter("cornering_stiffness", "1/rad", 15.0, 0.0, 1e3),
    )
    formula = (
        "wheel angle of module n = steer_angle_n + offset_n: offset_1, offset_2, offset_3, offset_4; side force of a "
        "wheel = −cornering_stiffness · mass · gravity / 4 · slip angle"
    )
    source = (
        "geometry of the module: the encoder's zero against the wheel's direction; Pacejka 2012, Tire and vehicle "
        "dynamics, §1.2: side force in proportion to the slip angle"
    )
    sentence = (
        "The wheels point {offset_1}, {offset_2}, {offset_3} and {offset_4} rad to the left of the readings "
        "of modules 1 to 4; zero the steering encoders again."
    )
    excitation = "accelerate hard along x, along y and in yaw, and record the chassis' own motion"
    symptom = "The robot drifts or yaws in a straight drive, and the drive motors need more torque."
    look_alikes = ("slope",)

    def starts(self) -> list[dict[str, float]]:
        """Return offsets to either side: wheels that work against each other drag alike to both."""
        size = {parameter.name: parameter.default for parameter in self.parameters}
        sides = itertools.product((1.0,), *[(1.0, -1.0)] * 3)
        return [
            size | {name: size[name] * side for name, side in zip(_OFFSETS, each, strict=True)}
            for each in sides
        ]

    def subject(self, values: Values) -> str:
        """Return the number of the module that is off by more than twice as much as any other one, or ""."""
        sizes = [abs(float(values[name])) for name in _OFFSETS]
        second, first = sorted(sizes)[-2:]
        return str(sizes.index(first) + 1) if first > _STANDS_OUT * second else ""

    def adjust(self, constants: Values, values: Values) -> dict[str, Any]:
        """Return the constants with the modules' offsets."""
        offsets = [torch.as_tensor(values[name], dtype=torch.float64) for name in _OFFSETS]
        return {**constants, "module_offset": torch.stack(offsets)}

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the change in the wheels' side forces on the chassis that the offsets cause."""
        angle = signals["steer_angle"]
        stiffness = values["cornering_stiffness"] * 0.25 * constants["mass"] * constants["gravity"]
        offset = constants["module_offset"].to(angle)
        added = _resistance(signals, angle + offset, constants) - _resistance(signals, angle, constants)
        return on_chassis(-stiffness * added)


def _resistance(signals: Signals, angle: Tensor, constants: Values) -> Tensor:
    """Return the generalised side force of wheels at angles (..., 4) rad per unit cornering stiffness, (..., 3)."""
    positions = constants["module_positions"].to(angle)
    twist = along_the_wheels(signals["chassis_velocity"], angle, constants)
    across = lateral_matrix(angle, positions)
    rolling = rolling_speed(twist, angle, positions)
    slip = (across * twist[..., None, :]).sum(-1) / torch.sqrt(rolling.square() + constants["creep"] ** 2)
    return (across * slip[..., None]).sum(-2)
