from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from simgap.errors import InputError
from simgap.logs.apply import recording_of
from simgap.logs.common_times import base_times, values_at
from simgap.logs.log import Log, Signal, Span
from simgap.logs.mapping import mapping_from_config
from simgap.logs.opening import open_recording


def _signal(
    name: str, time: np.ndarray, values: np.ndarray, unit: str | None = None, held: bool = False
) -> Signal:
    return Signal(name, time, values, unit, held)


def _log(*signals: Signal, spans: tuple[Span, ...] = ()) -> Log:
    return Log("test", "log", {signal.name: signal for signal in signals}, spans)


def test_a_joint_of_signals_with_times_of_their_own() -> None:
    slow, fast = np.linspace(0.0, 2.0, 101), np.linspace(0.0, 2.0, 1001)
    log = _log(
        _signal("angle", slow, np.rad2deg(np.sin(slow)), "deg"),
        _signal("rate", fast, -np.cos(fast)),
        _signal("volts", np.array([0.0, 1.0]), np.array([1.0, 2.0]), "V", held=True),
    )
    mapping = mapping_from_config(
        {"kind": "joint", "position": "angle", "velocity": {"from": "rate", "sign": -1}, "voltage": "volts"}
    )
    frame = recording_of(log, mapping).frame
    np.testing.assert_allclose(frame["t"], slow)
    np.testing.assert_allclose(frame["position"], np.sin(slow))
    np.testing.assert_allclose(frame["velocity"][1:-1], np.cos(slow)[1:-1], atol=1e-4)
    np.testing.assert_array_equal(frame["voltage"], np.where(slow < 1.0, 1.0, 2.0))


def test_spans_are_runs_and_a_held_value_lasts_into_them() -> None:
    time = np.linspace(0.0, 2.0, 21)
    log = _log(
        _signal("p", time, time),
        _signal("v", time, np.ones(21)),
        _signal("u", np.array([0.5]), np.array([3.0]), held=True),
        spans=(Span("one", 0.0, 0.95), Span("two", 1.05, 2.0)),
    )
    mapping = mapping_from_config({"kind": "joint", "position": "p", "velocity": "v", "voltage": "u"})
    recording = recording_of(log, mapping)
    assert recording.runs == ["one", "two"]
    second = recording.frame[recording.frame["run"] == "two"]
    assert second["t"].iloc[0] == 0.0
    assert (second["voltage"] == 3.0).all()


def test_a_gap_is_not_bridged() -> None:
    time = np.array([0.0, 0.1, 0.2, 0.3, 1.3, 1.4, 1.5])
    values = values_at(_signal("x", time, time), np.linspace(0.0, 1.5, 31), held=False)
    inside = np.isnan(values)
    assert inside[10:25].all()
    assert not inside[:6].any()


def test_averaging_of_a_faster_signal_keeps_a_line() -> None:
    fast = np.linspace(0.0, 1.0, 1001)
    times = np.linspace(0.1, 0.9, 9)
    np.testing.assert_allclose(values_at(_signal("x", fast, 3.0 * fast), times, held=False), 3.0 * times)


def test_a_uniform_rate_is_kept() -> None:
    time = np.linspace(0.0, 1.0, 11)
    signals = {"position": _signal("p", time, time), "velocity": _signal("v", time, time)}
    np.testing.assert_allclose(np.diff(base_times(signals, "joint", 50.0)), 0.02)


def test_a_root_is_for_a_share_only() -> None:
    with pytest.raises(InputError, match="has a root, and is in rad"):
        mapping_from_config({"kind": "joint", "position": {"from": "p", "root": True}})


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ({"kind": "arm"}, "no kind of platform"),
        ({"kind": "joint", "position": 3}, "names no signal"),
        ({"kind": "joint", "positon": "p"}, "did you mean 'position'"),
        ({"kind": "joint", "position": {"from": "p", "unit": "V"}}, "does not fit"),
        ({"kind": "joint", "position": {"from": "p", "sign": 2}}, "give 1 or -1"),
        ({"kind": "joint", "position": {"from": "p", "facto": 2}}, "unknown key"),
        ({"kind": "joint", "position": "p", "runs": {"a": [2, 1]}}, "before it begins"),
        ([1], "no mapping of columns"),
    ],
)
def test_a_wrong_mapping_is_refused_in_one_line(content: object, said: str) -> None:
    with pytest.raises(InputError, match=said):
        mapping_from_config(content)


def test_a_table_whose_clock_starts_anew_is_two_runs(tmp_path: Path) -> None:
    time = np.concatenate([np.arange(50), np.arange(50)]) * 20
    rows = "\n".join(f"{t},{0.1 * k},{0.5},{1.0}" for k, t in enumerate(time))
    path = tmp_path / "log.csv"
    path.write_text(f"stamp,angle,rate,volts\n{rows}\n")
    own = tmp_path / "mine.yaml"
    own.write_text(
        "kind: joint\nt: {from: stamp, unit: ms}\nposition: angle\nvelocity: rate\nvoltage: {from: volts, held: true}\n"
    )
    recording = open_recording(path, "joint", own)
    assert len(recording.runs) == 2
    assert any("clock" in warning for warning in recording.warnings)
    assert recording.frame["t"].max() == pytest.approx(0.98)


def test_a_mapping_of_a_table_with_the_names_of_the_contract_says_only_what_it_corrects(
    tmp_path: Path,
) -> None:
    time = np.linspace(0.0, 2.0, 201)
    columns = {
        "run": "a",
        "t": time,
        "position": np.sin(time),
        "velocity": np.cos(time),
        "effort": 0.0 * time,
    }
    frame = pd.DataFrame(columns)
    frame.assign(position=frame["position"] / (2.0 * np.pi)).to_csv(tmp_path / "log.csv", index=False)
    (tmp_path / "mine.yaml").write_text("position: {from: position, unit: rev}\n")
    mended = open_recording(tmp_path / "log.csv", "joint", tmp_path / "mine.yaml")
    assert mended.units["position"] == "rad"
    pd.testing.assert_frame_equal(mended.frame[list(columns)], frame, check_dtype=False)


def test_the_mappings_of_the_page_are_mappings() -> None:
    page = Path("docs/how_to/own_log.md").read_text(encoding="utf-8")
    blocks = [block.partition("```")[0] for block in page.split("```yaml\n")[1:]]
    assert len(blocks) >= 3
    for block in blocks:
        content = yaml.safe_load(block)
        mapping = mapping_from_config({"kind": "joint"} | content)
        assert set(mapping.columns) == set(content) - {"kind"}


def test_a_position_is_integrated_of_a_velocity_only() -> None:
    with pytest.raises(InputError, match="a unit of rad/s is needed"):
        mapping_from_config({"kind": "joint", "position": {"from": "p", "unit": "deg", "integrate": True}})
    with pytest.raises(InputError, match="integrate is 1"):
        mapping_from_config({"kind": "joint", "position": {"from": "p", "integrate": 1}})
