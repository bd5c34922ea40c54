"""The white box finds the parameters of machines that are known."""

import numpy as np
import pytest
import torch

from simgap.errors import InputError
from simgap.models.motion_equations import quadrotor_terms
from tests.pipeline.models import learnable
from tests.pipeline.models.synthetic import QUADROTOR


def fitted(recorded, **options):
    train, validation, held = learnable.parts_of(recorded)
    model = learnable.new_model("white_box", recorded, **options)
    model.fit(train, validation, learnable.QUICK)
    return model, held


def test_a_joint_that_obeys_the_equation_is_found_exactly():
    model, _ = fitted(learnable.linear_joint())
    effort, viscous, dry, spring, constant = model.tensors()["velocity"].tolist()
    assert effort == pytest.approx(1.0, abs=1e-9)
    assert viscous == pytest.approx(-0.8, abs=1e-9)
    assert spring == pytest.approx(-3.0, abs=1e-9)
    assert (dry, constant) == pytest.approx((0.0, 0.0), abs=1e-9)


def test_thrust_and_torques_of_a_quadrotor_are_found():
    own = fitted(learnable.quadrotor())[0].tensors()
    positions = np.array(QUADROTOR.rotor_positions)
    force = QUADROTOR.thrust_coefficient
    assert own["velocity_z"][0] == pytest.approx(force / QUADROTOR.mass, rel=0.02)
    roll, pitch = (
        force * positions[:, 1] / QUADROTOR.inertia[0],
        -force * positions[:, 0] / QUADROTOR.inertia[1],
    )
    directions = np.array(QUADROTOR.rotor_directions)
    assert own["body_rate_x"][:4].numpy() == pytest.approx(roll, rel=0.05)
    assert own["body_rate_y"][:4].numpy() == pytest.approx(pitch, rel=0.05)
    # About z the rotors of these flights pull together, so that only what they have in common shows.
    yaw = QUADROTOR.torque_coefficient / QUADROTOR.inertia[2]
    assert own["body_rate_z"][:4].numpy() @ directions / 4 == pytest.approx(yaw, rel=0.05)


def test_a_motor_of_a_swerve_drive_is_found_exactly():
    own = fitted(learnable.swerve())[0].tensors()
    # From v' = 0.9·v + 0.3·u every 0.02 s.
    assert own["steer_velocity_3"].tolist() == pytest.approx([15.0, -5.0, 0.0], abs=1e-9)


def test_gyroscopic_torques_do_no_work():
    """ω·τ = 0 of a rotor that spins about z: its terms about x and y take opposite coefficients."""
    generator = torch.Generator().manual_seed(0)
    features = torch.rand((5, 13), generator=generator, dtype=torch.float64) + 1.0
    terms = quadrotor_terms(features)
    momentum = torch.tensor([0.3, -0.2, 0.5, 0.1], dtype=torch.float64)
    about_x = torch.stack(terms[3][-4:], dim=-1) @ momentum
    about_y = torch.stack(terms[4][-4:], dim=-1) @ -momentum
    assert torch.allclose(
        features[:, 6] * about_x + features[:, 7] * about_y, torch.zeros(5, dtype=torch.float64)
    )


def test_a_window_longer_than_every_segment_is_refused():
    with pytest.raises(InputError, match=r"model\.averaging: no segment is as long as a window"):
        fitted(learnable.linear_joint(), averaging=100.0)
