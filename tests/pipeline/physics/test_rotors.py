import torch

from simgap.physics import rotors

POSITIONS = torch.tensor(
    [[0.1, -0.1, 0.0], [-0.1, -0.1, 0.0], [-0.1, 0.1, 0.0], [0.1, 0.1, 0.0]], dtype=torch.float64
)
DIRECTIONS = torch.tensor([-1.0, 1.0, -1.0, 1.0], dtype=torch.float64)


def wrench_of(speed: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
    lift = rotors.thrust(speed, 2e-6)
    return rotors.wrench(lift, rotors.reaction_torque(speed, 3e-8, DIRECTIONS), POSITIONS)


def test_equal_speeds_lift_without_twisting():
    force, torque = wrench_of(torch.full((4,), 1000.0, dtype=torch.float64))
    torch.testing.assert_close(force, torch.tensor([0.0, 0.0, 8.0], dtype=torch.float64))
    torch.testing.assert_close(torque, torch.zeros(3, dtype=torch.float64))


def test_wrench_is_the_sum_of_r_cross_f():
    speed = torch.rand(5, 4, dtype=torch.float64, generator=torch.Generator().manual_seed(0)) * 1e3
    force, torque = wrench_of(speed)
    lift = torch.zeros(5, 4, 3, dtype=torch.float64)
    lift[..., 2] = 2e-6 * speed**2
    expected = torch.linalg.cross(POSITIONS.expand(5, 4, 3), lift).sum(dim=-2)
    expected[..., 2] += (3e-8 * DIRECTIONS * speed**2).sum(dim=-1)
    torch.testing.assert_close(torque, expected)
    torch.testing.assert_close(force, lift.sum(dim=-2))


def test_hub_velocity_is_the_derivative_of_the_hub_position():
    velocity = torch.tensor([[1.0, 2.0, 3.0]], dtype=torch.float64)
    yaw = torch.tensor([[0.0, 0.0, 2.0]], dtype=torch.float64)
    hubs = rotors.hub_velocity(velocity, yaw, POSITIONS)
    expected = velocity[:, None] + 2.0 * torch.stack(
        (-POSITIONS[:, 1], POSITIONS[:, 0], torch.zeros(4, dtype=torch.float64)), dim=-1
    )
    torch.testing.assert_close(hubs, expected)


def test_mirroring_the_speeds_mirrors_the_wrench():
    """Left and right exchanged: roll and yaw torque change sign, pitch torque and force do not."""
    speed = torch.tensor([900.0, 1000.0, 1100.0, 1200.0], dtype=torch.float64)
    force, torque = wrench_of(speed)
    mirrored_force, mirrored_torque = wrench_of(speed[[3, 2, 1, 0]])
    torch.testing.assert_close(mirrored_force, force)
    torch.testing.assert_close(mirrored_torque, torque * torch.tensor([-1.0, 1.0, -1.0], dtype=torch.float64))


def test_gradients():
    speed = torch.rand(3, 4, dtype=torch.float64, generator=torch.Generator().manual_seed(0))
    assert torch.autograd.gradcheck(wrench_of, speed.requires_grad_())


def test_power_is_torque_times_speed_either_way_round():
    speed = torch.tensor([-800.0, 0.0, 900.0, 2000.0], dtype=torch.float64)
    torque = rotors.reaction_torque(speed, 3e-8, torch.ones(4, dtype=torch.float64))
    torch.testing.assert_close(rotors.shaft_power(speed, 3e-8), torque * speed.abs())
