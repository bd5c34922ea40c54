import math

import pytest
import yaml

from simgap.errors import InputError
from simgap.models.simulated import read_learned_simulator
from simgap.models.storage import save_model
from simgap.platforms.settings import SimulatorSettings
from simgap.recordings.recording import write_recording
from simgap.runner import StageRun
from simgap.simulation import read_simulator
from simgap.stages.build_sim import BuildSimStage, build_sim
from tests.pipeline.gap.recordings import JOINT, Plant, joint_recording
from tests.pipeline.models import learnable
from tests.stages.test_diagnose import PLATFORM


@pytest.fixture
def recorded(tmp_path):
    path = tmp_path / "recording.parquet"
    write_recording(joint_recording(Plant(friction=0.3)), path)
    return path


def _built(recorded, tmp_path, name, effects):
    output = tmp_path / name
    output.mkdir()
    run = StageRun(output)
    settings = SimulatorSettings(effects=effects)
    build_sim(BuildSimStage(recording=str(recorded), platform=PLATFORM, simulator=settings), run)
    return output, run.metrics


def test_the_simulator_is_written_as_text_and_read_back(recorded, tmp_path):
    output, metrics = _built(recorded, tmp_path, "nominal", {})
    simulator = read_simulator(output)
    assert simulator.platform == JOINT
    assert simulator.effects == ()
    assert simulator.position_unit == "rad"
    content = yaml.safe_load((output / "simulator.yaml").read_text())
    assert content["platform"]["inertia"] == 0.05
    assert set(metrics) == {"replay_error_position", "replay_error_velocity"}
    assert all(math.isfinite(value) for value in metrics.values())


def test_a_simulator_with_what_is_known_replays_better(recorded, tmp_path):
    _, without = _built(recorded, tmp_path, "without", {})
    output, known = _built(recorded, tmp_path, "with", {"coulomb_friction": {"level": 0.3}})
    for name, value in known.items():
        assert value < 0.2 * without[name]
    (effect,) = read_simulator(output).effects
    assert effect.known
    assert dict(effect.values) == {"level": 0.3}


def test_the_same_input_gives_the_same_bytes(recorded, tmp_path):
    outputs = [_built(recorded, tmp_path, name, {})[0] for name in ("first", "second")]
    first, second = ((output / "simulator.yaml").read_bytes() for output in outputs)
    assert first == second


@pytest.mark.parametrize(
    ("effects", "told"),
    [
        ({"coulomb_fricton": {}}, "did you mean 'coulomb_friction'"),
        ({"coulomb_friction": {"lewel": 0.3}}, "use level"),
    ],
)
def test_a_wrong_effect_is_named(recorded, tmp_path, effects, told):
    with pytest.raises(InputError, match=told):
        _built(recorded, tmp_path, "wrong", effects)


@pytest.fixture
def learned(tmp_path):
    """Write a recording of a linear plant, and the model of a branch that has learned it; return the recording."""
    recorded = learnable.linear_joint()
    train, validation, _ = learnable.parts_of(recorded)
    model = learnable.new_model("state_space", recorded, cutoff=None, ridge=0.0)
    model.fit(train, validation, learnable.QUICK)
    save_model(model, tmp_path / "train" / "model")
    path = tmp_path / "linear.parquet"
    write_recording(recorded, path)
    return path


def _learned(learned, tmp_path, **settings):
    output = tmp_path / "learned"
    output.mkdir()
    run = StageRun(output)
    config = BuildSimStage(
        artifacts=str(tmp_path),
        recording=str(learned),
        platform={"kind": "joint", "inertia": 2.0},
        simulator=SimulatorSettings(**settings),
    )
    build_sim(config, run)
    return output, run.metrics


def test_a_trained_model_moves_the_simulator_and_the_diagnosis_reads_its_physics(learned, tmp_path):
    output, metrics = _learned(learned, tmp_path, dynamics="train")
    assert all(value < 1e-6 for value in metrics.values())
    assert read_learned_simulator(output).learned is not None
    assert read_simulator(output).learned is None
    content = yaml.safe_load((output / "simulator.yaml").read_text())["learned"]
    assert (content["role"], content["model"], content["layout"]) == ("dynamics", "state_space", "joint")


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        ({"dynamics": "train", "residual": "train"}, "set one of the two to null"),
        ({"residual": "train"}, "use simulator.dynamics"),
        ({"dynamics": "nowhere/train/model"}, "run simgap train first"),
    ],
)
def test_a_model_that_cannot_be_that_part_is_one_line(learned, tmp_path, settings, told):
    with pytest.raises(InputError, match=told) as refused:
        _learned(learned, tmp_path, **settings)
    assert "\n" not in str(refused.value)
