"""Modules of a swerve drive whose zero is not straight ahead."""

from typing import Any

import torch

from pipeline.effects.effect import ConstantEffect, Parameter, Values

_OFFSETS = tuple(f"offset_{module}" for module in range(1, 5))


class ModuleMisalignment(ConstantEffect):
    """Each wheel points elsewhere than its encoder says: it pulls and rolls there."""

    name = "module_misalignment"
    kind = "swerve"
    acts_on = "chassis"
    parameters = tuple(Parameter(offset, "rad", 0.05, -0.8, 0.8) for offset in _OFFSETS)
    formula = "wheel angle of module n = steer_angle_n + offset_n: offset_1, offset_2, offset_3, offset_4"
    source = "geometry of the module: the encoder's zero against the wheel's direction"
    sentence = (
        "The wheels point {offset_1}, {offset_2}, {offset_3} and {offset_4} rad to the left of what modules 1 to 4 "
        "measure; set the zeros of the steering encoders anew."
    )
    excitation = (
        "accelerate hard along x, along y and about the vertical, with the chassis' own motion measured"
    )

    def adjust(self, constants: Values, values: Values) -> dict[str, Any]:
        """Return the constants with the modules' offsets."""
        offsets = [torch.as_tensor(values[name], dtype=torch.float64) for name in _OFFSETS]
        return {**constants, "module_offset": torch.stack(offsets)}
