"""Parameters that are set and simulated come back from the recording, for every effect of the catalogue."""

import pytest

from tests.pipeline.effects.experiments import recorded_blocks, recovered
from tests.pipeline.platforms.machines import EVERY_EFFECT, identity

# Where the default of any machine does not show on this one.
VALUES = {
    "joint-current_limit": {"limit": 2.0},
    "joint-backlash": {"gap": 0.05},
    "joint-motor_inductance": {"inductance": 0.04},
    "joint-temperature_derating": {"coefficient": 0.006},
}
# Samples in s and integration steps in each, where a hidden state runs ahead or behind by a part of a step.
STEPS = {
    "joint-backlash": (5e-4, 4),
    "joint-motor_inductance": (2e-3, 8),
    "joint-stribeck_friction": (1e-3, 1),
    "quadrotor-motor_lag": (2e-3, 4),
    "quadrotor-tip_path_plane_flapping": (2e-3, 2),
}


# What half a second of shaking does not show, at these steps: long swings, many coefficients, coupling.
NOT_SHOWN = {
    "quadrotor-grey_box_aerodynamics",
    "quadrotor-slung_payload",
    "swerve-backlash@steer",
    "swerve-current_limit@steer",
    "swerve-drive_steer_coupling@drive",
    "swerve-module_misalignment@chassis",
    "swerve-motor_inductance@drive",
    "swerve-motor_inductance@steer",
    "swerve-stribeck_friction@steer",
    "swerve-viscous_friction@steer",
}
SHOWN = [effect for effect in EVERY_EFFECT if identity(effect) not in NOT_SHOWN]


@pytest.mark.parametrize("effect", SHOWN, ids=identity)
def test_what_is_set_and_simulated_is_found_again(effect):
    values = effect.defaults() | VALUES.get(identity(effect), {})
    found = recovered(effect, recorded_blocks(effect, values, *STEPS.get(identity(effect), ())))
    assert found == pytest.approx(values, rel=0.01)
