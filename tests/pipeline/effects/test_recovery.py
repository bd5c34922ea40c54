"""Parameters that are set and simulated come back from the recording, for every effect of the catalogue."""

import pytest

from tests.pipeline.effects.experiments import recorded_blocks, recovered
from tests.pipeline.platforms.machines import EVERY_EFFECT, identity

# Where the default of any machine does not show on this one.
VALUES = {
    "joint-current_limit": {"limit": 2.0},
    "joint-backlash": {"gap": 0.05},
    "joint-flexible_coupling": {"damping_ratio": 0.2},
    "joint-motor_inductance": {"inductance": 0.04},
    "joint-temperature_derating": {"coefficient": 0.006},
    "swerve-current_limit@steer": {"limit": 10.0},
    "swerve-stribeck_friction@drive": {"velocity": 5.0},
    "swerve-stribeck_friction@steer": {"velocity": 2.0},
}
# Samples in s and integration steps in each: where a hidden state runs ahead or behind by a part of a step, where an
# effect is faint beside the error of averages over samples, and where it passes within a few of them.
_SHORT = (1e-3, 1)
STEPS = {
    "joint-backlash": (1e-3, 2),
    "joint-flexible_coupling": (1e-3, 4),
    "joint-motor_inductance": (2e-3, 8),
    "quadrotor-slung_payload": (4e-3, 1),
    "quadrotor-tip_path_plane_flapping": (1e-3, 2),
    "swerve-motor_inductance@steer": (2e-3, 6),
    "swerve-tyre_creep@drive": _SHORT,
    **dict.fromkeys(
        ("joint-hysteresis", "joint-stribeck_friction", "quadrotor-grey_box_aerodynamics"), _SHORT
    ),
    **dict.fromkeys((f"swerve-{key}@chassis" for key in ("module_misalignment", "slope")), _SHORT),
    **dict.fromkeys(
        (f"swerve-{key}@steer" for key in ("backlash", "stribeck_friction", "viscous_friction")), _SHORT
    ),
}

# The rows of a fit take the momentum as it was recorded; see test_joint_drive.py for what a filter does to it.
RECOVERED = [effect for effect in EVERY_EFFECT if identity(effect) != "joint-velocity_filter"]


@pytest.mark.slow
@pytest.mark.parametrize("effect", RECOVERED, ids=identity)
def test_what_is_set_and_simulated_is_found_again(effect):
    values = effect.defaults() | VALUES.get(identity(effect), {})
    found = recovered(effect, recorded_blocks(effect, values, *STEPS.get(identity(effect), ())))
    assert found == pytest.approx(values, rel=0.01)
