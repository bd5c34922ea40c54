import pytest
import torch
from hypothesis import given, settings
from hypothesis import strategies as st

from simgap.diagnosis.diagnose import acting_regimes, regimes_on
from simgap.diagnosis.evidence import _depends_on, _law
from simgap.diagnosis.regimes import Regime
from simgap.effects import effects_of
from simgap.effects.joint.common import commanded
from simgap.simulation import FittedEffect
from tests.pipeline.gap.problems import problem_of
from tests.pipeline.gap.recordings import Plant, joint_recordings, joint_simulator

_JOINT = {effect.name: effect for effect in effects_of("joint")}


def _regime(name: str, values: torch.Tensor, of: str = "") -> tuple[Regime, torch.Tensor]:
    return Regime(name, "1", values, of or name), values


def _drawn(law: torch.Tensor, regimes: list[tuple[Regime, torch.Tensor]]) -> dict:
    return _law(law, law, regimes, torch.arange(len(law)))


def test_dry_friction_is_a_step_at_zero_velocity_even_where_effort_orders_it_as_well():
    velocity = torch.linspace(-2.0, 3.0, 4001, dtype=torch.float64)
    law = -0.4 * velocity.sign()
    effort = 0.4 * velocity.sign() + 0.01 * velocity
    regimes = [
        _regime("effort", effort),
        _regime("position", velocity.cumsum(0)),
        _regime("velocity", velocity),
    ]
    needed = _depends_on(_JOINT["coulomb_friction"], regimes)
    assert [regime.name for regime, _ in needed] == ["velocity", "effort"]
    drawn = _drawn(law, needed)
    assert drawn["variable"] == "velocity"
    at_zero = [y for x, y in zip(drawn["x"], drawn["law"], strict=True) if x == 0.0]
    assert at_zero[0] > 0.39
    assert at_zero[-1] < -0.39
    assert all(abs(abs(y) - 0.4) < 1e-3 for y in drawn["law"])


def test_a_law_is_not_drawn_across_values_that_were_not_recorded():
    effort = torch.cat([torch.linspace(-2.0, -1.0, 600), torch.linspace(1.0, 1.5, 600)]).double()
    drawn = _drawn(0.3 * effort, [_regime("effort", effort)])
    (gap,) = [x for x, y in zip(drawn["x"], drawn["law"], strict=True) if y is None]
    assert -1.0 < gap < 1.0


def test_a_smooth_law_is_one_line():
    effort = torch.randn(3000, dtype=torch.float64, generator=torch.Generator().manual_seed(3))
    drawn = _drawn(0.3 * effort, [_regime("effort", effort)])
    assert None not in drawn["law"]
    assert drawn["x"] == sorted(set(drawn["x"]))  # no step at zero


@pytest.mark.parametrize("level", [0.1, -0.7])
def test_a_law_over_values_that_repeat_is_drawn(level):
    """The mean of equal values may be off by a rounding, and so lie below all that was recorded."""
    values = torch.tensor([level, 0.8, 5.9], dtype=torch.float64).repeat_interleave(
        torch.tensor([101, 300, 300])
    )
    drawn = _drawn(0.3 * values, [_regime("voltage", values)])
    assert drawn["x"][0] == pytest.approx(level)
    assert drawn["law"] == [pytest.approx(0.3 * level), None, pytest.approx(0.3 * drawn["x"][-1])]


@settings(max_examples=50)
@given(
    levels=st.lists(st.integers(-9, 9), min_size=3, max_size=5, unique=True),
    size=st.floats(1e-6, 1e6),
    seed=st.integers(0, 99),
)
def test_values_that_differ_by_rounding_are_one_value(levels, size, seed):
    random = torch.Generator().manual_seed(seed)
    exact = size * torch.tensor(sorted(levels), dtype=torch.float64).repeat_interleave(100)
    rounded = exact * (1.0 + 1e-15 * torch.randn(len(exact), dtype=torch.float64, generator=random))
    expected, found = (_drawn(0.3 * exact, [_regime("effort", values)]) for values in (exact, rounded))
    assert found["x"] == pytest.approx(expected["x"], abs=1e-9 * size)
    assert [height is None for height in found["law"]] == [height is None for height in expected["law"]]
    heights = ([height for height in drawn["law"] if height is not None] for drawn in (found, expected))
    assert next(heights) == pytest.approx(next(heights), abs=1e-9 * size)


def test_an_effect_of_no_such_variable_is_drawn_over_any():
    regimes = [_regime("velocity", torch.linspace(0.0, 1.0, 9))]
    assert _depends_on(_JOINT["command_delay"], regimes) == regimes


def test_variables_are_shown_as_recorded_and_not_as_the_simulator_scales_them():
    (recording,) = joint_recordings(Plant(), [0], runs=3)
    scaled = _JOINT["input_scale_error"]
    simulator = joint_simulator().with_effects((FittedEffect(scaled, {"ratio": 2.2}, known=True),))
    blocks = problem_of(recording, simulator).blocks
    shown, acting = (
        {regime.name: regime.series for regime in regimes(blocks, simulator)}
        for regimes in (regimes_on, acting_regimes)
    )
    name = commanded(blocks.signals)
    torch.testing.assert_close(shown[name], blocks.inner(blocks.signals[name]))
    torch.testing.assert_close(acting[name], 2.2 * shown[name])
