import pytest
import torch

from simgap.errors import InputError
from simgap.models.layouts import layout_from_mapping, layout_of
from simgap.models.windows import series_of
from simgap.platforms import platform_to_config
from tests.pipeline.models import learnable
from tests.pipeline.models.rig import rig
from tests.pipeline.models.synthetic import QUADROTOR

RECORDINGS = {
    "joint": learnable.linear_joint,
    "swerve": learnable.swerve,
    "swerve_chassis": learnable.swerve,
    "steering": learnable.swerve,
    "all_steering": learnable.swerve,
    "quadrotor": learnable.quadrotor,
    "attitude": rig,
    "motor_command": rig,
    "motor_setpoint": rig,
}


@pytest.fixture(params=RECORDINGS)
def steps(request):
    """Layout, states, the states after them, inputs and time step of a run."""
    recorded = RECORDINGS[request.param]()
    layout = layout_of(recorded, request.param).on(platform_to_config(QUADROTOR))
    train = series_of(recorded, layout, ["a"])
    last = int(train.bounds[0, 1])
    return layout, train.states[: last - 1], train.states[1:last], train.actions[: last - 1], train.time_step


def test_advancing_by_the_true_increment_gives_the_next_state(steps):
    layout, states, following, _, time_step = steps
    reached = layout.advance(states, layout.increment(states, following), time_step)
    tolerances = {"position": 2e-3, "attitude": 2e-4, "steer_angle": 0.05}
    for name, error in layout.errors(reached, following).items():
        assert error.max() < tolerances.get(name, 1e-9), name


def test_what_is_named_is_what_there_is(steps):
    layout, states, following, actions, _ = steps
    assert layout.encode(states, actions).shape[1] == len(layout.features)
    assert layout.increment(states, following).shape[1] == len(layout.targets)
    assert set(layout.targets) <= set(layout.states)
    assert 0 < layout.input_features <= len(layout.features)


def test_no_difference_is_no_error(steps):
    layout, states, _following, _, _ = steps
    assert all(error.abs().max() < 1e-6 for error in layout.errors(states, states).values())
    apart = layout.errors(states, states + 1.0)
    assert any(error.max() > 1e-3 for error in apart.values())


def test_a_layout_survives_its_description(steps):
    layout = steps[0]
    assert layout_from_mapping(layout.as_mapping()) == layout


def test_heading_and_place_do_not_matter_to_a_quadrotor():
    recorded = learnable.quadrotor()
    layout = layout_of(recorded)
    train, _, _ = learnable.parts_of(recorded)
    from simgap.physics import rotations

    states, half = train.states[:50], torch.tensor(0.4, dtype=torch.float64)
    turn = torch.stack([torch.cos(half), 0 * half, 0 * half, torch.sin(half)]).expand(50, 4)
    moved = states.clone()
    moved[:, :3] += 7.0
    moved[:, 3:7] = rotations.multiply(turn, states[:, 3:7])
    moved[:, 7:10] = rotations.rotate(turn, states[:, 7:10])
    actions = train.actions[:50]
    assert torch.allclose(layout.encode(moved, actions), layout.encode(states, actions), atol=1e-9)


def test_full_turns_do_not_matter_to_a_turning_joint():
    layout = layout_from_mapping({"kind": "joint", "inputs": ["voltage"], "sliding": False})
    state, action = torch.tensor([[0.3, 1.0]]), torch.tensor([[2.0]])
    wound = state + torch.tensor([[6 * torch.pi, 0.0]])
    assert torch.allclose(layout.encode(state, action), layout.encode(wound, action), atol=1e-5)


def test_every_rotor_moves_with_the_body_and_its_turning():
    recorded = rig()
    layout = layout_of(recorded, "motor_command").on(platform_to_config(QUADROTOR))
    half = torch.tensor(0.25 * torch.pi, dtype=torch.float64)  # turned to the left by a quarter
    attitude = torch.stack([half.cos(), 0 * half, 0 * half, half.sin()])
    velocity, rate = torch.tensor([[0.0, 3.0, 0.0], [0.0, 0.0, 2.0]], dtype=torch.float64)
    seen = layout.encode(torch.zeros(4, dtype=torch.float64), torch.cat([attitude, velocity, rate]))
    rotors = seen[:12].view(4, 3)
    for place, rotor in zip(QUADROTOR.rotor_positions, rotors, strict=True):
        expected = torch.tensor([3.0 - 2.0 * place[1], 2.0 * place[0], 0.0], dtype=torch.float64)
        assert torch.allclose(rotor, expected)
    assert torch.equal(seen[12:], rate)


def test_all_eight_motors_are_seen_and_the_four_steering_motors_predicted():
    layout = layout_of(learnable.swerve(), "all_steering")
    stems = ("steer_velocity", "drive_velocity", "drive_voltage", "steer_voltage")
    assert layout.features == tuple(f"{stem}_{number}" for stem in stems for number in range(1, 5))
    assert layout.targets == tuple(f"steer_velocity_{number}" for number in range(1, 5))


def test_published_inputs_of_a_motor_are_the_motion_and_the_setpoints_of_its_own_instant():
    recorded = rig()
    layout = layout_of(recorded, "motor_setpoint")
    assert layout.features == (
        *(f"body_velocity_{axis}" for axis in "xyz"),
        *(f"body_rate_{axis}" for axis in "xyz"),
        *(f"body_rate_command_{axis}" for axis in "xyz"),
    )
    series = series_of(recorded, layout, ["a"])
    frame = recorded.frame[recorded.frame["run"] == "a"]
    seen = layout.encode(series.states, series.actions)
    assert seen[:, 6].tolist() == frame["body_rate_command_x"].tolist()[1:]


def test_motion_is_taken_as_much_later_as_a_command_needs_to_show():
    recorded = rig()
    layout = layout_of(recorded, "motor_command")
    assert layout.lead == 2  # the sample that follows, and 0.02 s at 50 Hz
    series = series_of(recorded, layout, ["a"])
    frame = recorded.frame[recorded.frame["run"] == "a"]
    assert len(series) == len(frame) - 2
    rate = layout.inputs.index("body_rate_x")
    assert series.actions[:, rate].tolist() == frame["body_rate_x"].tolist()[2:]


@pytest.mark.parametrize(
    ("name", "complaint"),
    [
        ("attitud", "did you mean 'attitude'"),
        ("boat", "use one of quadrotor"),
        ("attitude", "needs the column 'body_rate_command_x'"),
        ("motor_command", "needs the column 'motor_command_1'"),
    ],
)
def test_a_layout_that_does_not_fit_is_refused(name, complaint):
    with pytest.raises(InputError, match=complaint):
        layout_of(learnable.quadrotor(), name)


def test_motor_commands_need_a_quadrotor():
    layout = layout_of(rig(), "motor_command")
    joint = {"kind": "joint", "inertia": 1.0}
    with pytest.raises(InputError, match="is a joint, not a quadrotor"):
        layout.on(joint)


def test_nonsense_is_no_layout():
    with pytest.raises(InputError, match="describes no known platform"):
        layout_from_mapping({"kind": "joint", "wheels": 3})


def test_a_layout_is_found_by_its_name():
    recorded = learnable.swerve()
    assert layout_of(recorded, "swerve") == layout_of(recorded)


@pytest.mark.parametrize(
    ("name", "complaint"),
    [("swerv", "did you mean 'swerve'"), ("joint", "needs the column 'position', which was not recorded")],
)
def test_a_layout_that_does_not_fit_the_recording_is_refused(name, complaint):
    with pytest.raises(InputError, match=complaint):
        layout_of(learnable.swerve(), name)
