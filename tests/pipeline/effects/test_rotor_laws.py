"""Laws of a quadrotor's rotors: how they follow their command, carry angular momentum and meet the air."""

import math

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from simgap.physics import rigid_body, rotations
from simgap.physics.induced_velocity import induced_velocity
from simgap.physics.integrators import rk4
from simgap.physics.rotors import hub_velocity
from simgap.plants.rotor import Rotor
from simgap.simulation import FittedEffect, Simulator
from tests.pipeline.effects.responses import TIME_STEP, actuated, assert_same, constants
from tests.pipeline.effects.rotors import HOVER, SEED, hovering, of
from tests.pipeline.platforms.machines import QUADROTOR, some_signals


@pytest.mark.parametrize("time_constant", [0.002, 0.04, 0.3])
def test_a_step_of_the_command_is_followed_along_an_exponential(time_constant):
    command = torch.zeros(1, 50, 4, dtype=torch.float64)
    command[:, 10:] = 0.5
    signals = actuated("quadrotor", {"motor_command": command})
    speed = of("motor_lag").along_time(
        signals, {"time_constant": time_constant}, constants("quadrotor"), TIME_STEP
    )["rotor_speed"]
    edges = torch.arange(41, dtype=torch.float64) * TIME_STEP
    area = edges + time_constant * torch.exp(-edges / time_constant)  # under 1 − e^(−t/T)
    mean = 0.5 * QUADROTOR.motor_speed_max * torch.diff(area) / TIME_STEP
    torch.testing.assert_close(speed[0, 10:, 0], mean, rtol=1e-10, atol=1e-9)
    assert not speed[:, :10].any()


def test_a_motor_lags_a_ramp_by_its_time_constant_and_no_half_sample_more():
    ramp = torch.arange(200, dtype=torch.float64)[None, :, None].expand(1, 200, 4) * TIME_STEP
    signals = {"rotor_speed": ramp}
    lagged = of("motor_lag").along_time(signals, {"time_constant": 0.03}, constants("quadrotor"), TIME_STEP)
    torch.testing.assert_close((ramp - lagged["rotor_speed"])[:, -20:], torch.full((1, 20, 4), 0.03).double())


@given(share=st.floats(0.5, 1.2), sensitivity=st.floats(0.0, 2.0))
def test_rotor_speed_falls_with_the_voltage(share, sensitivity):
    signals = {
        "motor_command": torch.full((4,), 0.5, dtype=torch.float64),
        "battery_voltage": torch.tensor(share * QUADROTOR.nominal_voltage, dtype=torch.float64),
    }
    signals = actuated("quadrotor", signals)
    out, _ = of("battery_sag").actuate(
        signals, {"sensitivity": sensitivity}, constants("quadrotor"), None, 1.0
    )
    expected = 0.5 * QUADROTOR.motor_speed_max * (1.0 + sensitivity * (share - 1.0))
    torch.testing.assert_close(out["rotor_speed"], torch.full((4,), expected, dtype=torch.float64))


@pytest.mark.parametrize("rotor", [1, 2, 3, 4])
def test_a_rotor_that_gives_nothing_is_a_rotor_that_stands(rotor):
    signals = some_signals("quadrotor", (5,), seed=rotor)
    fault = FittedEffect(of(f"rotor_fault@{rotor}"), {f"loss_{rotor}": 1.0})
    found = Simulator(QUADROTOR, (fault,)).balance(signals).wrench
    signals["rotor_speed"][..., rotor - 1] = 0.0
    assert_same(found, Simulator(QUADROTOR).balance(signals).wrench)


@given(seed=SEED)
def test_a_steady_wind_pushes_the_same_way_in_the_world_whichever_way_the_machine_points(seed):
    signals = some_signals("quadrotor", (5,), seed)
    wind, push = of("steady_wind"), {"push_x": 0.4, "push_y": -0.7}
    whole, across = (
        wind.wrench(signals, {**push, "axial_share": share}, constants("quadrotor")) for share in (1.0, 0.0)
    )
    force = torch.stack([whole[f"force_{axis}"] for axis in "xyz"], dim=-1)
    world = rotations.rotate(signals["attitude"], force)
    torch.testing.assert_close(world, torch.tensor([[0.4, -0.7, 0.0]] * 5, dtype=torch.float64))
    torch.testing.assert_close(across["force_x"], whole["force_x"])
    assert not across["force_z"].any()


@given(seed=SEED)
def test_a_wind_makes_the_drag_over_ground_the_square_law_of_the_airspeed(seed):
    """Both effects together are −c·|u|·u with u = v − wind, whatever the speed."""
    signals = some_signals("quadrotor", (5,), seed)
    wind, coefficient = torch.tensor([3.0, -4.0, 0.0], dtype=torch.float64), 0.05
    push = coefficient * wind.norm() * wind
    values = {
        "push_x": float(push[0]),
        "push_y": float(push[1]),
        "axial_share": 1.0,
        "slowness": float(1.0 / wind.norm()),
    }
    blown = of("steady_wind").wrench(signals, values, constants("quadrotor"))
    drag = of("body_drag").wrench(signals, {"coefficient": coefficient}, constants("quadrotor"))
    airspeed = signals["velocity"] - rotations.rotate_inverse(signals["attitude"], wind.expand(5, 3))
    expected = -coefficient * airspeed.norm(dim=-1, keepdim=True) * airspeed
    found = torch.stack([blown[f"force_{axis}"] + drag[f"force_{axis}"] for axis in "xyz"], dim=-1)
    torch.testing.assert_close(found, expected)


def test_drag_along_the_rotor_axis_may_be_greater_than_across():
    signals = some_signals("quadrotor", (5,), seed=3)
    drag, values = of("body_drag"), {"coefficient": 0.03}
    even, uneven = (
        drag.wrench(signals, values | more, constants("quadrotor")) for more in ({}, {"axial_excess": 0.015})
    )
    torch.testing.assert_close(uneven["force_z"], 1.5 * even["force_z"])
    assert_same({"force_x": uneven["force_x"]}, {"force_x": even["force_x"]})


@pytest.mark.parametrize(
    ("key", "values", "share"),
    [
        ("rotor_thrust_spread", {"excess_1": 0.01, "excess_2": -0.02, "excess_3": 0.005}, 0.02),
        ("rotor_thrust_spread", {"excess_1": 0.01, "excess_2": 0.01, "excess_3": 0.01}, 0.03),
        ("yaw_trim", {"imbalance": -0.004}, 0.004),
    ],
)
def test_rotors_that_are_nearly_alike_stand_for_a_coefficient_that_is_off(key, values, share):
    assert of(key).stands_for(values, constants("quadrotor")) == pytest.approx(share)


@pytest.mark.parametrize("kind", [float, torch.tensor])  # numbers are followed by a compiled loop
@pytest.mark.parametrize(("up", "down"), [(0.02, 0.08), (0.08, 0.02), (0.03, 0.03)])
def test_rotors_rise_with_one_time_constant_and_fall_with_another(up, down, kind):
    target = torch.full((1, 120, 1), 1000.0, dtype=torch.float64)
    target[:, 20:70] = 1500.0
    values = {"time_constant": math.sqrt(up * down), "down_ratio": kind(down / up)}
    lagged = of("motor_lag").along_time({"rotor_speed": target}, values, constants("quadrotor"), TIME_STEP)
    edges = torch.arange(51, dtype=torch.float64) * TIME_STEP
    rise = edges + up * torch.exp(-edges / up)  # under 1 − e^(−t/T)
    expected = 1000.0 + 500.0 * torch.diff(rise) / TIME_STEP
    torch.testing.assert_close(lagged["rotor_speed"][0, 20:70, 0], expected, rtol=1e-6, atol=0.0)
    top = 1000.0 + 500.0 * (1.0 - math.exp(-float(edges[-1]) / up))
    fall = -down * torch.exp(-edges / down)
    expected = 1000.0 + (top - 1000.0) * torch.diff(fall) / TIME_STEP
    torch.testing.assert_close(lagged["rotor_speed"][0, 70:, 0], expected, rtol=1e-6, atol=0.0)


def test_a_lag_of_one_time_constant_may_leave_its_ratio_out():
    signals = {"rotor_speed": some_signals("quadrotor", (2, 50), seed=5)["rotor_speed"]}
    lag = of("motor_lag")
    even, left_out, solved = (
        lag.along_time(signals, {"time_constant": 0.03} | ratio, constants("quadrotor"), TIME_STEP)
        for ratio in ({"down_ratio": 1.0}, {}, {"down_ratio": torch.tensor(1.0, dtype=torch.float64)})
    )
    assert_same(even, left_out)
    assert_same(even, solved, rtol=1e-9)
    assert lag.completed({"time_constant": 0.03}) == {"time_constant": 0.03, "down_ratio": 1.0}


@given(seed=SEED)
def test_the_gyroscopic_torque_does_no_work(seed):
    signals = some_signals("quadrotor", (20,), seed)
    wrench = of("gyroscopic_torque").wrench(signals, {"inertia": 1e-3}, constants("quadrotor"))
    torque = torch.stack([wrench[f"torque_{axis}"] for axis in "xyz"], dim=-1)
    power = (torque * signals["body_rate"]).sum(-1)
    assert (power.abs() <= 1e-12 * torque.norm(dim=-1) * signals["body_rate"].norm(dim=-1) + 1e-15).all()


def test_body_and_rotors_in_free_space_keep_their_angular_momentum():
    """Without air the motors only pass angular momentum between rotors and body."""
    inertia = 1e-4
    effects = (of("gyroscopic_torque"), of("rotor_inertia_torque"))
    numbers = constants("quadrotor") | {"thrust_coefficient": 0.0, "torque_coefficient": 0.0}
    moments = numbers["inertia"]

    def rotors(time: float) -> dict[str, torch.Tensor]:
        pace = torch.tensor([5.0, 3.0, 4.0, 7.0], dtype=torch.float64)
        return {
            "rotor_speed": 1000.0 + 900.0 * torch.sin(pace * time),
            "rotor_acceleration": 900.0 * pace * torch.cos(pace * time),
        }

    def rate_of_change(state: torch.Tensor) -> torch.Tensor:
        attitude, rate, time = state[:4], state[4:7], float(state[7])
        signals = {"body_rate": rate, **rotors(time)}
        torque = torch.zeros(3, dtype=torch.float64)
        for effect in effects:
            for channel, value in effect.wrench(signals, {"inertia": inertia}, numbers).items():
                torque["xyz".index(channel[-1])] += value
        acceleration = rigid_body.angular_acceleration(rate, torque, moments)
        return torch.cat([rotations.quaternion_derivative(attitude, rate), acceleration, torch.ones(1)])

    def momentum(state: torch.Tensor) -> torch.Tensor:
        spin = -(numbers["rotor_directions"] * rotors(float(state[7]))["rotor_speed"]).sum()
        own = torch.stack([torch.zeros_like(spin), torch.zeros_like(spin), inertia * spin])
        return rotations.rotate(state[:4], moments * state[4:7] + own)

    state = torch.tensor([1.0, 0.0, 0.0, 0.0, 3.0, -2.0, 1.0, 0.0], dtype=torch.float64)
    start = momentum(state)
    for _ in range(150):
        state = rk4(rate_of_change, state, 2e-3)
    assert float(rotations.rotation_angle(state[:4], torch.tensor([1.0, 0, 0, 0]).double())) > 0.1
    torch.testing.assert_close(momentum(state), start, rtol=0.0, atol=1e-7)


@pytest.mark.parametrize("rotor", range(4))
def test_speeding_a_rotor_up_twists_the_body_as_its_air_drag_does(rotor):
    """The motor pushes the rotor round against both, so the body feels both the same way."""
    acceleration = torch.zeros(4, dtype=torch.float64)
    acceleration[rotor] = 100.0
    torque = of("rotor_inertia_torque").wrench(
        {"rotor_acceleration": acceleration}, {"inertia": 1e-5}, constants("quadrotor")
    )["torque_z"]
    assert float(torque) == pytest.approx(QUADROTOR.rotor_directions[rotor] * 1e-3)


@given(climb=st.floats(-3.0, 12.0), sensitivity=st.floats(0.1, 4.0), induced=st.floats(3.0, 15.0))
def test_the_inflow_of_a_climb_is_that_of_the_closed_form(climb, sensitivity, induced):
    """Along the axis blade elements and momentum meet in a quadratic equation (Leishman 2006, §2.13 and §3.2)."""
    signals = {name: series[0] for name, series in hovering(1).items()}
    signals["velocity"] = torch.tensor([[0.0, 0.0, climb]], dtype=torch.float64)
    values = {"sensitivity": sensitivity, "induced_velocity": induced, "induced_share": 0.6}
    through = _through_the_disc(climb, sensitivity, induced)
    if through <= 0.1 * induced:  # the wake blows back: no steady inflow along the axis
        return
    wrench = of("inflow_ratio").wrench(signals, values, constants("quadrotor"))
    expected = -QUADROTOR.gravity * sensitivity * (through / induced - 1.0)
    assert float(wrench["force_z"]) == pytest.approx(expected, rel=1e-9, abs=1e-9)
    assert float(wrench["force_z"]) * climb <= 1e-9
    assert float(wrench["torque_x"].abs() + wrench["torque_y"].abs()) < 1e-12


def _through_the_disc(climb: float, sensitivity: float, induced: float) -> float:
    linear = sensitivity * induced - climb
    return 0.5 * (-linear + math.sqrt(linear**2 + 4.0 * (1.0 + sensitivity) * induced**2))


def test_level_flight_gains_thrust_up_to_a_rotor_without_induced_velocity():
    speeds = torch.tensor([0.0, 2.0, 5.0, 10.0, 20.0, 1e4], dtype=torch.float64)
    signals = {name: series[0].expand(6, -1) for name, series in hovering(1).items()}
    signals["velocity"] = torch.stack([speeds, 0 * speeds, 0 * speeds], dim=-1)
    values = {"sensitivity": 1.5, "induced_velocity": 6.0, "induced_share": 0.6}
    gain = of("inflow_ratio").wrench(signals, values, constants("quadrotor"))["force_z"]
    assert float(gain[0]) == pytest.approx(0.0, abs=1e-12)
    assert (torch.diff(gain) > 0).all()
    assert float(gain[-1]) == pytest.approx(1.5 * QUADROTOR.gravity, rel=2e-3)


@pytest.mark.parametrize("climb", [-1.0, 0.0, 4.0])
def test_a_rotor_takes_the_power_of_its_profile_and_of_its_thrust_against_the_inflow(climb):
    """Q·Ω = profile + T·(v_z + u). One rotor is faster, so that its torque is not met by its neighbours'."""
    signals = {name: series[0] for name, series in hovering(1).items()}
    signals["rotor_speed"] = torch.tensor([[1.0, 1.2, 1.0, 1.0]], dtype=torch.float64) * HOVER
    signals["velocity"] = torch.tensor([[0.0, 0.0, climb]], dtype=torch.float64)
    values = {"sensitivity": 1.5, "induced_velocity": 6.0, "induced_share": 0.6}
    wrench = of("inflow_ratio").wrench(signals, values, constants("quadrotor"))

    def added_torque(pace: float) -> float:
        through = _through_the_disc(climb, 1.5, 6.0 * pace) / (6.0 * pace)
        thrust = 1.0 - 1.5 * (through - 1.0)
        return 0.6 * QUADROTOR.torque_coefficient * (pace * HOVER) ** 2 * (thrust * through - 1.0)

    expected = QUADROTOR.rotor_directions[1] * (added_torque(1.2) - added_torque(1.0))
    assert float(wrench["torque_z"]) == pytest.approx(expected, rel=1e-6, abs=1e-12)


@given(seed=SEED)
def test_air_goes_through_a_disc_as_its_thrust_pushes_it(seed):
    """Momentum theory with Glauert's rule: u·√(V² + (v_z + u)²) stays what it is in still air."""
    still, crossing, climb = 8.0 * torch.rand(3, 50, generator=torch.Generator().manual_seed(seed)).double()
    still, climb = still + 1.0, climb - 4.0
    induced = induced_velocity(still, crossing.square(), climb, 0.0)
    settled = crossing > 0.6 * still  # slower descents meet their own wake, without a steady inflow
    pushed = induced * (crossing.square() + (climb + induced).square()).sqrt()
    torch.testing.assert_close(pushed[settled], still.square()[settled], rtol=1e-6, atol=0.0)
    assert (induced > 0).all()
    assert induced.isfinite().all()


@given(seed=SEED)
def test_each_disc_tilts_as_a_rotor_of_blade_elements_in_its_own_stream(seed):
    """The tilt is (8/3·pitch − 2·λ)·μ, that of the rotors of the concealed plants."""
    rotor, numbers = Rotor(QUADROTOR.thrust_coefficient, radius=0.12), constants("quadrotor")
    still, tip = rotor.still_inflow_ratio * rotor.radius * HOVER, rotor.radius * HOVER
    lean = rotor.pitch * 8.0 / 3.0 - 2.0 * still / tip
    values = {"tilt": lean / tip, "time_constant": 0.0, "stiffness": 0.0, "inflow": 2.0 * still / tip / lean}
    values["induced_velocity"] = still
    signals = some_signals("quadrotor", (1, 5), seed)
    signals["velocity"] = signals["velocity"].clamp(-4.0, 4.0)
    found = of("tip_path_plane_flapping").along_time(signals, values, numbers, TIME_STEP)["disc_tilt"]
    hub = hub_velocity(signals["velocity"], signals["body_rate"], numbers["rotor_positions"])
    pace = signals["rotor_speed"] / HOVER
    induced = induced_velocity(still * pace, hub[..., :2].square().sum(-1), hub[..., 2], 0.0)
    ratio = (hub[..., 2] + induced) / (tip * pace)
    expected = (8.0 / 3.0 * rotor.pitch - 2.0 * ratio) / (tip * pace)
    torch.testing.assert_close(found, expected[..., None] * hub[..., :2], rtol=1e-9, atol=1e-12)


def test_discs_in_a_steady_stream_drag_as_rotor_drag_says():
    signals = hovering(3)
    signals["velocity"] = torch.tensor([[[4.0, -2.0, 0.0]] * 3], dtype=torch.float64)
    flapping, numbers = of("tip_path_plane_flapping"), constants("quadrotor")
    values = flapping.completed({"tilt": 0.02, "time_constant": 0.03, "stiffness": 0.0})
    found = flapping.wrench(flapping.along_time(signals, values, numbers, TIME_STEP), values, numbers)
    drag = of("rotor_drag").wrench(signals, {"coefficient": 0.02 * QUADROTOR.gravity}, numbers)
    assert_same({name: found[name] for name in drag}, drag)


def test_discs_keep_their_plane_in_space_while_the_body_turns_and_settle_a_time_constant_behind():
    signals = hovering(200)
    rate = torch.zeros(1, 200, 3, dtype=torch.float64)
    rate[:, 1:, :2] = torch.tensor([0.3, 0.5], dtype=torch.float64)
    signals["body_rate"] = rate
    flapping, numbers = of("tip_path_plane_flapping"), constants("quadrotor")
    values = flapping.completed({"tilt": 0.0, "time_constant": 0.05, "stiffness": 0.0})
    tilt = flapping.along_time(signals, values, numbers, 1e-4)["disc_tilt"]
    turned = 0.5 * (torch.arange(200) - 0.5) * 1e-4
    assert tilt[0, 5, :, 0].tolist() == pytest.approx([float(turned[5])] * 4, rel=0.02)
    later = flapping.along_time(signals, values, numbers, 0.01)["disc_tilt"]
    behind = 0.05 * torch.tensor([[0.5, -0.3]] * 4, dtype=torch.float64)
    torch.testing.assert_close(later[0, -1], behind)


@given(seed=SEED)
def test_tilted_discs_twist_the_body_by_their_stiffness_and_the_lever_of_their_thrust(seed):
    signals, numbers = some_signals("quadrotor", (6,), seed), constants("quadrotor")
    tilt = 0.01 * torch.randn(6, 4, 2, generator=torch.Generator().manual_seed(seed), dtype=torch.float64)
    wrench = of("tip_path_plane_flapping").wrench({**signals, "disc_tilt": tilt}, {"stiffness": 0.2}, numbers)
    thrust = numbers["thrust_coefficient"] * signals["rotor_speed"].square()
    in_plane = torch.cat([-thrust[..., None] * tilt, torch.zeros(6, 4, 1, dtype=torch.float64)], dim=-1)
    torque = torch.linalg.cross(numbers["rotor_positions"].expand_as(in_plane), in_plane).sum(-2)
    hinge = 0.05 * torch.stack([tilt[..., 1].sum(-1), -tilt[..., 0].sum(-1), 0.0 * tilt[:, 0, 0]], dim=-1)
    found = torch.stack([wrench[f"torque_{axis}"] for axis in "xyz"], dim=-1)
    torch.testing.assert_close(found, torque + hinge)


@given(seed=SEED)
def test_learnt_aerodynamics_hold_the_named_laws_that_are_of_their_form(seed):
    signals, numbers = some_signals("quadrotor", (6,), seed), constants("quadrotor")
    learnt = of("grey_box_aerodynamics")
    weight = QUADROTOR.mass * QUADROTOR.gravity
    values = learnt.neutral() | {
        "quadratic_lift": 0.02,
        "thrust_offset_y": -0.004 * weight,
        "thrust_offset_x": 0.003 * weight,
    }
    found = learnt.wrench(signals, values, numbers)
    lift = of("translational_lift").wrench(signals, {"coefficient": 0.02}, numbers)
    offset = of("center_of_mass_offset").wrench(signals, {"offset_x": 0.003, "offset_y": 0.004}, numbers)
    assert_same({name: found[name] for name in ("force_z", "torque_x", "torque_y")}, lift | offset, 1e-9)
    assert not any(found[name].any() for name in ("force_x", "force_y", "torque_z"))
