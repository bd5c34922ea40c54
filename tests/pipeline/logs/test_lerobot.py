import json
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given, settings

from simgap.errors import InputError
from simgap.logs.formats import format_of, read_log
from simgap.logs.layouts.lerobot import propose
from simgap.logs.readers.lerobot import read
from simgap.recordings.contract import COLUMNS
from tests.pipeline.logs.damage import assert_a_log_or_one_line, damaged

FPS = 30
FRAMES = 40
NAMES = ["elbow.pos", "gripper.pos"]


def table(episode: int, size: float = 50.0, version: int = 3) -> pa.Table:
    phase = np.arange(FRAMES) / 10
    state = np.stack([size * np.sin(phase) + episode, 80 * np.cos(phase)], axis=1).astype("f4")
    kind = pa.list_(pa.float32(), 2) if version == 3 else pa.list_(pa.float32())
    return pa.table(
        {
            "action": pa.array((state + 1).tolist(), kind),
            "observation.state": pa.array(state.tolist(), kind),
            "timestamp": pa.array((np.arange(FRAMES) / FPS).astype("f4")),
            "frame_index": np.arange(FRAMES),
            "episode_index": np.full(FRAMES, episode),
            "task": ["lift"] * FRAMES,
        }
    )


def data_set(folder: Path, version: int, size: float = 50.0, names: Any = NAMES) -> Path:
    (folder / "meta").mkdir(parents=True)
    (folder / "data/chunk-000").mkdir(parents=True)
    features = {key: {"dtype": "float32", "names": names} for key in ("action", "observation.state")}
    info = {"codebase_version": f"v{version}.0", "robot_type": "so101", "fps": FPS, "features": features}
    (folder / "meta/info.json").write_text(json.dumps(info))
    tables = [table(episode, size, version) for episode in range(3)]
    if version == 3:
        pq.write_table(pa.concat_tables(tables), folder / "data/chunk-000/file-000.parquet")
    else:
        for episode, content in enumerate(tables):
            pq.write_table(content, folder / f"data/chunk-000/episode_{episode:06d}.parquet")
    return folder


@pytest.mark.parametrize("version", [2, 3])
def test_each_episode_is_a_run_and_each_joint_a_signal(tmp_path: Path, version: int) -> None:
    names = NAMES if version == 3 else {"motors": NAMES}
    log = read_log(data_set(tmp_path / "set", version, names=names))
    assert [span.name for span in log.spans] == ["episode_0", "episode_1", "episode_2"]
    signal = log.signals["observation.state[elbow]"]
    assert (np.diff(signal.time) > 0).all()
    for number, span in enumerate(log.spans):
        inside = (signal.time >= span.begin) & (signal.time <= span.end)
        np.testing.assert_allclose(
            signal.values[inside], 50 * np.sin(np.arange(FRAMES) / 10) + number, atol=1e-4
        )
        np.testing.assert_allclose(np.diff(signal.time[inside]), 1 / FPS, atol=1e-9)
    assert log.signals["action[gripper]"].held
    assert "task" not in log.signals


def test_one_file_knows_its_data_set_and_does_without(tmp_path: Path) -> None:
    folder = data_set(tmp_path / "set", 3)
    file = folder / "data/chunk-000/file-000.parquet"
    assert "action[elbow]" in read_log(file).signals
    alone = tmp_path / "file-000.parquet"
    alone.write_bytes(file.read_bytes())
    assert format_of(alone).name == "LeRobot data set"
    assert "action[0]" in read_log(alone).signals


@pytest.mark.parametrize(
    ("size", "unit", "sure"), [(150.0, "deg", True), (90.0, "deg", False), (1.5, "rad", False)]
)
def test_degrees_are_sure_beyond_a_hundred_only(tmp_path: Path, size: float, unit: str, sure: bool) -> None:
    proposal = propose(read_log(data_set(tmp_path / "set", 3, size)))
    assert proposal is not None
    position = proposal.columns["position"]
    assert (position.source.signal, position.source.unit) == ("observation.state[elbow]", unit)
    assert (position.confidence >= 0.9) == sure
    if "position_command" in COLUMNS["joint"]:
        assert proposal.columns["position_command"].source.signal == "action[elbow]"
    else:
        assert "no torque" in proposal.missing["effort"]


def test_what_does_not_move_or_is_no_arm_is_refused(tmp_path: Path) -> None:
    log = read_log(data_set(tmp_path / "set", 3, size=0.0, names=["gripper_left", "gripper_right"]))
    proposal = propose(log)
    assert proposal is not None
    assert "no observation.state of a joint" in proposal.refusal
    other = propose(log, "quadrotor")
    assert other is not None
    assert "not of a quadrotor" in other.refusal


@pytest.mark.parametrize(("name", "said"), [("meta/info.json", "JSON"), ("data", "data/chunk")])
def test_an_incomplete_data_set_is_refused(tmp_path: Path, name: str, said: str) -> None:
    folder = data_set(tmp_path / "set", 3)
    if name == "data":
        (folder / "data").rename(folder / "other")
    else:
        (folder / name).write_text("{")
    with pytest.raises(InputError, match=said):
        read_log(folder)


@pytest.fixture(scope="module")
def content(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("parquet") / "a.parquet"
    pq.write_table(table(0), path)
    return path.read_bytes()


@settings(max_examples=30)
@given(seed=damaged(bytes(range(256)) * 12))
def test_damage_gives_a_log_or_one_line(
    tmp_path_factory: pytest.TempPathFactory, content: bytes, seed: bytes
) -> None:
    changed = bytearray(content)  # the damage of the seed, laid on the file
    for place in (index for index, value in enumerate(seed[: len(content)]) if value != index % 256):
        changed[place] ^= seed[place]
    path = tmp_path_factory.getbasetemp() / "damaged.parquet"
    assert_a_log_or_one_line(read, path, bytes(changed))


def test_the_real_data_set(shared_data: Path) -> None:
    log = read_log(shared_data / "raw/lerobot_so101_recordtest")
    assert len(log.spans) == 4
    assert len(log.signals["action[elbow_flex]"].values) == 1492
    proposal = propose(log)
    assert proposal is not None
    assert proposal.columns["position"].source.signal == "observation.state[shoulder_lift]"
    assert not proposal.is_sure  # nothing beyond 100: degrees or percent


def test_numbers_are_those_of_the_file_and_times_add_up_in_64_bits(tmp_path: Path) -> None:
    stored = table(0)
    episodes = pa.array(np.repeat([0, 1], FRAMES))
    both = pa.concat_tables([stored, stored]).set_column(4, "episode_index", episodes)
    path = tmp_path / "file-000.parquet"
    pq.write_table(both, path)
    log = read_log(path)
    signal = log.signals["observation.state[1]"]
    assert signal.values.dtype == signal.time.dtype == np.float64
    own = stored["timestamp"].to_numpy().astype(np.float64)
    expected = np.concatenate([own, own[-1] + 1.0 + own])
    np.testing.assert_array_equal(signal.time, expected)
    values = np.stack(stored["observation.state"].to_pylist())[:, 1]
    np.testing.assert_array_equal(signal.values, np.tile(values, 2))
