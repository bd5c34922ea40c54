"""What each effect of a swerve drive does, exactly, in cases that can be worked out by hand."""

import math

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from simgap.effects import effect_by_key
from simgap.physics.friction import stribeck_level
from simgap.platforms.swerve_kinematics import module_states
from simgap.platforms.swerve_mechanism import MEASURED, ROLLED
from simgap.platforms.swerve_slip import CREEP, CREEP_ACROSS
from simgap.simulation import FittedEffect, Simulator, rollout
from simgap.simulation.motion import motion_of
from tests.pipeline.effects.responses import TIME_STEP, actuated, constants
from tests.pipeline.platforms.machines import SWERVE, some_signals

NUMBERS = constants("swerve")
POSITIONS = NUMBERS["module_positions"]
SEEDS = st.integers(0, 10**6)
GROUPS = pytest.mark.parametrize("group", ["drive", "steer"])


def four(value: float) -> torch.Tensor:
    return torch.full((4,), value, dtype=torch.float64)


def signals_of(seed: int = 0, **given_signals: torch.Tensor) -> dict[str, torch.Tensor]:
    """Return random signals of one instant with some of them given, actuated unless a torque is given."""
    signals = some_signals("swerve", (), seed)
    voltages = {name: value for name, value in given_signals.items() if not name.endswith("torque")}
    return actuated("swerve", signals | voltages) | given_signals


def changed(key: str, values: dict[str, float], signals: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
    return effect_by_key("swerve", key).actuate(signals, values, NUMBERS, None, TIME_STEP)[0]


def acting(key: str, values: dict[str, float], signals: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
    return effect_by_key("swerve", key).wrench(signals, values, NUMBERS)


def with_effect(key: str, **values: float) -> Simulator:
    return Simulator(SWERVE, (FittedEffect(effect_by_key("swerve", key), values),))


@GROUPS
@given(seed=SEEDS, sensitivity=st.floats(0.0, 2.0))
def test_a_motor_under_a_sagging_battery_is_one_that_gets_less_voltage(group, seed, sensitivity):
    signals = signals_of(seed)
    found = changed(f"battery_sag@{group}", {"sensitivity": sensitivity}, signals)
    share = 1.0 + sensitivity * (signals["battery_voltage"] / 12.0 - 1.0)
    voltage = f"{group}_voltage"
    expected = actuated("swerve", some_signals("swerve", (), seed) | {voltage: share * signals[voltage]})
    torch.testing.assert_close(found[voltage], expected[voltage])
    torch.testing.assert_close(found[f"{group}_torque"], expected[f"{group}_torque"])


@GROUPS
def test_current_rises_with_the_windings_time_constant(group):
    inductance, steps = 0.01, 40
    lag = inductance / NUMBERS[f"{group}_resistance"]
    torque = torch.zeros(1, steps, 4, dtype=torch.float64)
    torque[:, 1:] = 3.0
    effect = effect_by_key("swerve", f"motor_inductance@{group}")
    name = f"{group}_torque"
    found = effect.along_time({name: torque}, {"inductance": inductance}, NUMBERS, TIME_STEP)[name][0, 1:, 0]
    ends = torch.arange(1, steps, dtype=torch.float64) * TIME_STEP
    antiderivative = ends + lag * torch.exp(-ends / lag)
    before = (ends - TIME_STEP) + lag * torch.exp(-(ends - TIME_STEP) / lag)
    torch.testing.assert_close(found, 3.0 * (antiderivative - before) / TIME_STEP)


@GROUPS
@given(speed=st.floats(1.0, 30.0), extra=st.floats(0.1, 5.0), velocity=st.floats(0.5, 20.0))
def test_stribeck_friction_fades_from_breaking_away_as_its_law_says(group, speed, extra, velocity):
    """Far above the sliding velocity; at rest it holds what is applied."""
    moving = {"drive_velocity": four(speed * NUMBERS["drive_gear_ratio"]), "steer_velocity": four(speed)}
    torque = {f"{group}_torque": four(0.05)}
    values = {"extra_level": extra, "velocity": velocity}
    forward = {"steer_angle": four(0.0)}
    key, channel = f"stribeck_friction@{group}", {"drive": "drive_x", "steer": "steer_1"}[group]
    scale = 4.0 / SWERVE.wheel_radius if group == "drive" else 1.0
    found = acting(key, values, signals_of(**moving, **forward, **torque))[channel] / scale
    level = stribeck_level(torch.tensor(speed, dtype=torch.float64), 0.0, extra, velocity)
    torch.testing.assert_close(found, -level, rtol=1e-6, atol=1e-9)
    still = {name: torch.zeros_like(value) for name, value in moving.items()}
    held = acting(key, values, signals_of(**still, **forward, **torque))[channel] / scale
    assert float(held) == pytest.approx(-0.05)


@given(rolling=st.floats(0.1, 3.0), turning=st.floats(1.0, 15.0), radius=st.floats(0.005, 0.1))
def test_scrubbing_falls_as_the_wheel_rolls_and_is_dry_friction_at_rest(rolling, turning, radius):
    level = 0.7
    values = {"level": level, "patch_radius": radius}
    speed = four(rolling / SWERVE.wheel_radius * NUMBERS["drive_gear_ratio"])
    torque = {"steer_torque": four(10.0)}
    moving = signals_of(drive_velocity=speed, steer_velocity=four(turning), **torque)
    share = radius * turning / math.hypot(radius * turning, rolling)
    found = acting("scrub_torque@steer", values, moving)["steer_3"]
    torch.testing.assert_close(found, torch.tensor(-level * share, dtype=torch.float64), rtol=2e-3, atol=1e-9)
    standing = signals_of(drive_velocity=four(0.0), steer_velocity=four(turning), **torque)
    torch.testing.assert_close(
        acting("scrub_torque@steer", values, standing),
        acting("coulomb_friction@steer", {"level": level}, standing),
    )


@given(seed=SEEDS, grip=st.floats(0.05, 2.0))
def test_no_wheel_pulls_beyond_its_friction_circle_and_below_it_nothing_changes(seed, grip):
    signals = signals_of(seed)
    found = changed("wheel_slip@drive", {"friction_coefficient": grip}, signals)["drive_torque"]
    x, y, yaw = signals["chassis_velocity"]
    angle, quarter = signals["steer_angle"], SWERVE.mass / 4.0
    side = quarter * yaw * (x * torch.cos(angle) + y * torch.sin(angle))
    limit = grip * quarter * SWERVE.gravity
    wanted = signals["drive_torque"] / SWERVE.wheel_radius
    share = torch.clamp(limit / torch.hypot(wanted, side), max=1.0)
    torch.testing.assert_close(found / SWERVE.wheel_radius, share * wanted)
    assert (torch.hypot(found / SWERVE.wheel_radius, share * side) <= limit * (1 + 1e-12)).all()


def test_a_wheel_slides_where_its_grip_is_used_up_and_nowhere_else():
    signals = signals_of(drive_torque=four(2.0))
    signals["chassis_velocity"] = torch.zeros(3, dtype=torch.float64)
    used = 2.0 / SWERVE.wheel_radius / (0.25 * SWERVE.mass * SWERVE.gravity)
    for grip, sliding in ((0.9 * used, 1.0), (1.2 * used, 1.0), (1.5 * used, 0.0), (3.0 * used, 0.0)):
        found = changed("wheel_slip@drive", {"friction_coefficient": grip}, signals)["sliding"]
        torch.testing.assert_close(found, four(sliding))


def test_a_robot_that_slips_starts_no_faster_than_its_grip():
    volts = torch.full((1, 10, 4), 12.0, dtype=torch.float64)
    commands = {"drive_voltage": volts, "steer_voltage": torch.zeros_like(volts)}
    initial = torch.zeros(1, 12, dtype=torch.float64)
    states = rollout(with_effect("wheel_slip@drive", friction_coefficient=0.3), initial, commands, 0.005)
    time = torch.arange(11, dtype=torch.float64) * 0.005
    torch.testing.assert_close(states[0, :, 0], 0.3 * SWERVE.gravity * time)


@given(seed=SEEDS, compliance=st.floats(0.0, 0.3))
def test_treads_creep_in_proportion_to_pull_and_speed_and_drift_with_the_side_force(seed, compliance):
    signals = signals_of(seed)
    found = changed("tyre_creep@drive", {"compliance": compliance}, signals)
    torch.testing.assert_close(found["drive_torque"], signals["drive_torque"])
    rolling = signals["drive_velocity"] / NUMBERS["drive_gear_ratio"] * SWERVE.wheel_radius
    load = 0.25 * SWERVE.mass * SWERVE.gravity
    pull = signals["drive_torque"] / SWERVE.wheel_radius
    torch.testing.assert_close(found["creep_along"], compliance * pull / load * rolling.abs())
    # What bends the path of a rolling wheel is its speed times the rate at which its direction turns.
    side = 0.25 * SWERVE.mass * rolling * (signals["chassis_velocity"][2] + signals["steer_velocity"])
    torch.testing.assert_close(found["creep_across"], -compliance * side / load * rolling.abs())


def test_in_a_simulation_a_creeping_wheel_pulls_as_much_less_as_its_motor_would_turn_faster():
    compliance = 0.1
    signals = {n: s for n, s in signals_of().items() if n != MEASURED}
    found = changed("tyre_creep@drive", {"compliance": compliance}, signals)
    faster = found["creep_along"] * NUMBERS["drive_gear_ratio"] / SWERVE.wheel_radius
    expected = actuated("swerve", signals | {"drive_velocity": signals["drive_velocity"] + faster})
    torch.testing.assert_close(found["drive_torque"], expected["drive_torque"])


def test_a_robot_whose_wheels_drift_alike_moves_aside():
    """All wheels ahead and pushed to the left: the whole robot drifts, and along its wheels nothing changes."""
    signals = signals_of(steer_angle=four(0.0)) | {MEASURED: torch.tensor([2.0, -0.03, 0.0]).double()}
    constants, mechanism = NUMBERS, with_effect("tyre_creep@drive", compliance=0.0).mechanism
    drifting = mechanism.readings(signals | {CREEP_ACROSS: four(-0.03)}, constants)
    for channel, moved in (("across_x", 2.0), ("across_y", -0.03), ("across_yaw", 0.0)):
        assert float(drifting[channel][1]) == pytest.approx(moved, abs=1e-3)


@given(heading=st.floats(-7.0, 7.0), rise=st.tuples(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3)))
def test_the_weight_pulls_down_the_same_slope_whichever_way_the_robot_faces(heading, rise):
    signals = signals_of() | {"heading": torch.tensor(heading, dtype=torch.float64)}
    pull = acting("slope@chassis", {"rise_x": rise[0], "rise_y": rise[1]}, signals)
    x, y = float(pull["drive_x"]), float(pull["drive_y"])
    cosine, sine, weight = math.cos(heading), math.sin(heading), SWERVE.mass * SWERVE.gravity
    world = (x * cosine - y * sine, x * sine + y * cosine)
    assert world == pytest.approx((-weight * rise[0], -weight * rise[1]), abs=1e-9)


def test_a_robot_left_on_a_slope_rolls_down_where_its_wheels_let_it():
    angle = 0.6
    state = torch.tensor([[0.0] * 3 + [angle] * 4 + [0.0] * 5], dtype=torch.float64)
    simulator = with_effect("slope@chassis", rise_x=0.1, rise_y=0.0)
    free = NUMBERS["drive_torque_constant"] * NUMBERS["drive_back_emf_constant"] / NUMBERS["drive_resistance"]
    braking = 4.0 * free * (NUMBERS["drive_gear_ratio"] / SWERVE.wheel_radius) ** 2 / SWERVE.mass
    still = torch.zeros(1, 50, 4, dtype=torch.float64)
    states = rollout(simulator, state, {"drive_voltage": still, "steer_voltage": still}, 0.01)[0]
    time = torch.arange(51, dtype=torch.float64) * 0.01
    down = -0.1 * SWERVE.gravity * math.cos(angle) * (1.0 - torch.exp(-braking * time)) / braking
    expected = torch.stack([down * math.cos(angle), down * math.sin(angle)], dim=-1)
    torch.testing.assert_close(states[:, :2], expected, rtol=2e-3, atol=1e-4)


@given(seed=SEEDS, ratio=st.floats(-10.0, 10.0))
def test_the_power_of_coupled_motors_is_that_of_wheels_and_modules(seed, ratio):
    """Virtual work: what turns with the motor pushes back in the same measure."""
    simulator = with_effect("drive_steer_coupling@drive", ratio=ratio)
    numbers, motion = simulator.constants(), motion_of(SWERVE)
    signals = some_signals("swerve", (), seed)
    signals |= motion.signals(motion.pack(signals), numbers)
    torques = {"drive_torque": four(2.0) + signals["drive_voltage"], "steer_torque": four(0.0)}
    acts = simulator.mechanism.wrench(signals | torques, numbers)
    chassis = torch.stack([acts[f"drive_{axis}"] for axis in ("x", "y", "yaw")])
    modules = torch.stack([acts[f"steer_{module}"] for module in range(1, 5)])
    given_power = torques["drive_torque"] / SWERVE.drive.gear_ratio @ signals["drive_velocity"]
    taken = chassis @ signals["chassis_velocity"] + modules @ signals["steer_velocity"]
    torch.testing.assert_close(given_power, taken)


def test_turning_the_modules_of_a_coupled_drive_turns_its_motors():
    simulator, motion = with_effect("drive_steer_coupling@drive", ratio=2.5), motion_of(SWERVE)
    state = torch.zeros(12, dtype=torch.float64)
    state[7:11] = torch.tensor([1.0, -2.0, 0.0, 4.0])
    turned = motion.signals(state, simulator.constants())["drive_velocity"]
    torch.testing.assert_close(turned, 2.5 * state[7:11])


def misaligned(cornering_stiffness: float = 0.0, **offsets: float) -> Simulator:
    return with_effect("module_misalignment@chassis", cornering_stiffness=cornering_stiffness, **offsets)


@given(toe=st.floats(-0.3, 0.3), speed=st.floats(0.5, 4.0), stiffness=st.floats(0.0, 30.0))
def test_wheels_that_toe_in_are_dragged_over_the_ground(toe, speed, stiffness):
    toed = {"offset_1": -toe, "offset_2": toe, "offset_3": -toe, "offset_4": toe}
    signals = {
        "steer_angle": torch.zeros(1, 4, dtype=torch.float64),
        "chassis_velocity": torch.tensor([[speed, 0.0, 0.0]], dtype=torch.float64),
    }
    simulator = misaligned(stiffness, **toed)
    (fitted,) = simulator.effects
    found = fitted.effect.wrench(signals, fitted.values, simulator.constants())
    slip_angle = math.sin(toe) * speed / math.hypot(speed * math.cos(toe), CREEP)
    expected = -stiffness * SWERVE.mass * SWERVE.gravity * math.sin(toe) * slip_angle
    assert float(found["drive_x"]) == pytest.approx(expected, abs=1e-3)
    assert float(found["drive_y"]) == pytest.approx(0.0, abs=1e-3)
    assert float(found["drive_yaw"]) == pytest.approx(0.0, abs=1e-3)


@given(offset=st.floats(-0.5, 0.5), seed=SEEDS)
def test_misaligned_modules_are_aligned_ones_at_other_angles(offset, seed):
    offsets = {f"offset_{module}": offset * module for module in range(1, 5)}
    simulator, nominal = misaligned(**offsets), Simulator(SWERVE)
    signals = some_signals("swerve", (5, 3), seed)
    elsewhere = signals["steer_angle"] + offset * torch.arange(1.0, 5.0, dtype=torch.float64)
    found = simulator.balance(simulator.along_time(signals, TIME_STEP))
    turned = nominal.along_time(signals | {"steer_angle": elsewhere}, TIME_STEP)
    torch.testing.assert_close(found.rate, nominal.balance(turned).rate)


def test_a_robot_with_misaligned_modules_runs_where_they_point():
    offsets = {f"offset_{module}": 0.2 for module in range(1, 5)}
    volts = torch.full((1, 20, 4), 6.0, dtype=torch.float64)
    commands = {"drive_voltage": volts, "steer_voltage": torch.zeros_like(volts)}
    initial = torch.zeros(1, 12, dtype=torch.float64)
    last = rollout(misaligned(**offsets), initial, commands, 0.01)[0, -1]
    straight = rollout(Simulator(SWERVE), initial, commands, 0.01)[0, -1, 0]
    expected = straight * torch.tensor([math.cos(0.2), math.sin(0.2)], dtype=torch.float64)
    torch.testing.assert_close(last[:2], expected)


@given(ratio=st.floats(0.5, 2.0), offset=st.floats(-0.2, 0.2), coupling=st.floats(-1.0, 1.0), seed=SEEDS)
def test_motion_that_nobody_measured_is_taken_from_the_wheels_of_the_simulator(ratio, offset, coupling, seed):
    """Of a robot whose wheels are smaller, point elsewhere, and turn as its modules are steered."""
    simulator = Simulator(
        SWERVE,
        (
            FittedEffect(effect_by_key("swerve", "wheel_radius_error@drive"), {"ratio": ratio}),
            FittedEffect(effect_by_key("swerve", "drive_steer_coupling@drive"), {"ratio": coupling}),
            *misaligned(**{f"offset_{module}": offset for module in range(1, 5)}).effects,
        ),
    )
    drawn = some_signals("swerve", (), seed)
    twist, mechanism = drawn["chassis_velocity"], simulator.mechanism
    angle, _ = module_states(twist, POSITIONS, four(0.0))
    state = torch.cat([twist, angle - offset, drawn["steer_velocity"], four(0.0)[:1]])
    signals = motion_of(SWERVE).signals(state, simulator.constants())
    signals |= {"chassis_velocity": torch.zeros_like(twist), ROLLED: torch.zeros_like(twist)}
    found = mechanism.derived(signals, simulator.constants())["chassis_velocity"]
    torch.testing.assert_close(found, twist)
    assert float(mechanism.momentum(signals, simulator.constants())["drive_x"]) == pytest.approx(
        SWERVE.mass * float(twist[0])
    )


@given(ratio=st.floats(0.5, 2.0), seed=SEEDS)
def test_smaller_wheels_turn_faster_and_push_harder(ratio, seed):
    simulator, nominal = with_effect("wheel_radius_error@drive", ratio=ratio), Simulator(SWERVE)
    twist = some_signals("swerve", (), seed)["chassis_velocity"]
    angle, _ = module_states(twist, POSITIONS, four(0.0))
    motion = motion_of(SWERVE)
    state = torch.cat([twist, angle, four(0.0), four(0.0)[:1]])
    slow, fast = (motion.signals(state, s.constants())["drive_velocity"] for s in (nominal, simulator))
    torch.testing.assert_close(fast, slow / ratio)
    signals = signals_of(seed)
    weak, strong = (s.wrench(signals, s.constants())["drive_x"] for s in (nominal, simulator))
    torch.testing.assert_close(strong, weak / ratio)


@GROUPS
def test_a_stronger_motor_constant_gives_more_stall_torque_and_less_free_speed(group):
    numbers = with_effect(f"motor_constant_error@{group}", ratio=1.25).constants()
    motor = getattr(SWERVE, group).motor
    stall = numbers[f"{group}_torque_constant"] * motor.stall_current
    free = motor.nominal_voltage / numbers[f"{group}_back_emf_constant"]
    assert stall == pytest.approx(1.25 * motor.stall_torque)
    assert free == pytest.approx(motor.free_speed / 1.25)


@given(effort=st.floats(0.5, 20.0), gap=st.floats(0.005, 0.1))
def test_a_module_feels_nothing_of_a_reversal_until_its_motor_has_crossed_the_gap(effort, gap):
    """From rest under a constant torque the motor alone crosses in √(2·gap·J/torque)."""
    effect = effect_by_key("swerve", "backlash@steer")
    values = {"gap": gap, "motor_inertia_share": 0.4}
    step, inertia = 1e-3, 0.4 * NUMBERS["steer_inertia"]
    crossing = math.sqrt(2.0 * gap * inertia / effort)
    torque = torch.full((1, round(crossing / step) + 20, 4), effort, dtype=torch.float64)
    torque[:, 0] = -effort
    still = torch.zeros_like(torque)
    numbers = NUMBERS | {"steer_torque_constant": 0.0}
    signals = {"steer_torque": torque, "steer_velocity": still, "steer_voltage": still}
    out = effect.along_time(signals, values, numbers, step)["steer_torque"][0, 1:, 0]
    arrived = int((out.abs() > 1e-6 * effort).int().argmax())
    assert arrived * step == pytest.approx(crossing, abs=4 * step)
    torch.testing.assert_close(out[arrived + 3 :], torque[0, arrived + 4 :, 0])


def test_a_late_log_of_the_motion_is_put_right_by_delaying_both_voltages():
    signals = some_signals("swerve", (2, 50), seed=1)
    undone = effect_by_key("swerve", "sensor_time_offset@chassis").undo(signals, {"offset": 0.03}, 0.01)
    for name, series in signals.items():
        late = series[:, :-3] if name in ("drive_voltage", "steer_voltage") else series[:, 3:]
        torch.testing.assert_close(undone[name][:, 3:], late)
