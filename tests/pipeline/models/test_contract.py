"""What holds for every learned model."""

import pickle
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import torch
import yaml

from simgap.artifacts import hash_path
from simgap.errors import InputError
from simgap.models.contract import DynamicsModel, FitContext, Provenance
from simgap.models.evaluation import rollout_errors
from simgap.models.registry import MODELS
from simgap.models.storage import DESCRIPTION_FILE, TENSOR_FILE, load_model, save_model
from simgap.models.windows import gather
from tests.pipeline.models import learnable
from tests.pipeline.models.simulators import simulated

RECORDINGS = {"joint": learnable.linear_joint, "swerve": learnable.swerve, "quadrotor": learnable.quadrotor}

STATELESS = [name for name, model in MODELS.items() if model.begin is DynamicsModel.begin]

every_model = pytest.mark.parametrize("name", MODELS)
every_kind = pytest.mark.parametrize("kind", RECORDINGS)


@cache
def fitted(name, kind="joint", seed=0):
    recorded = RECORDINGS[kind]()
    train, validation, held = learnable.parts_of(recorded)
    model = learnable.new_model(name, recorded)
    if kind in learnable.NOT_FOR.get(name, ()):
        with pytest.raises(InputError, match="choose another model"):
            model.fit(train, validation, learnable.QUICK, FitContext(seed))
        pytest.skip(f"{name} is not made for a {kind}")
    loss = model.fit(train, validation, learnable.QUICK, FitContext(seed))
    return model, loss, held


def windows(model, held, steps=5):
    length = model.settings.sequence_length
    starts = held.starts(length + steps)[:20]
    states = gather(held.states, starts, length + steps)
    return states[:, :length], gather(held.actions, starts, length - 1 + steps), states[:, length:]


def test_every_model_of_the_configuration_is_tried_here():
    files = {path.stem for path in (Path(__file__).parents[3] / "conf" / "model").glob("*.yaml")}
    assert files == set(MODELS) == set(learnable.SMALL)


@every_model
def test_parts_are_models_and_identified_parameters_are_those_of_targets(name):
    model, _, held = fitted(name)
    states, actions, true = windows(model, held)
    assert all(part.rollout(states, actions).shape == true.shape for part in model.parts().values())
    assert set(model.identified()) <= set(model.layout.targets)


@pytest.mark.slow
@every_model
@every_kind
def test_a_simulator_that_a_model_moves_goes_where_its_rollout_does(name, kind):
    """Its window ends with the present sample, and what it predicts is seen next."""
    model, _, held = fitted(name, kind)
    states, actions, _ = windows(model, held)
    assert torch.allclose(simulated(model, states, actions), model.rollout(states, actions), atol=1e-6)


@every_model
@every_kind
def test_predictions_and_rollouts_agree_in_shape_and_first_step(name, kind):
    model, loss, held = fitted(name, kind)
    states, actions, true = windows(model, held)
    rolled = model.rollout(states, actions)
    assert np.isfinite(loss)
    assert rolled.shape == true.shape
    assert rolled.isfinite().all()
    length = model.settings.sequence_length
    assert torch.equal(model.predict(states, actions[:, :length]), rolled[:, 0])


@pytest.mark.parametrize("name", STATELESS)
def test_a_rollout_of_what_remembers_its_window_is_predictions_fed_back(name):
    model, _, held = fitted(name)
    states, actions, _ = windows(model, held, steps=4)
    length, window = model.settings.sequence_length, states
    for step in range(4):
        following = model.predict(window, actions[:, step : step + length])
        window = torch.cat([window[:, 1:], following[:, None]], dim=1)
    assert torch.allclose(model.rollout(states, actions)[:, -1], window[:, -1], atol=1e-6)


@every_model
@every_kind
def test_what_comes_later_changes_nothing_before(name, kind):
    model, _, held = fitted(name, kind)
    states, actions, _ = windows(model, held, steps=6)
    longer = model.rollout(states, actions)
    changed = actions.clone()
    changed[:, -3:] += 1.0
    assert torch.equal(model.rollout(states, changed)[:, :3], longer[:, :3])
    assert torch.allclose(model.rollout(states, actions[:, :-3]), longer[:, :3], atol=1e-6)


def test_a_machine_that_a_model_does_not_know_is_refused():
    class Known(MODELS["linear"]):
        kinds = frozenset({"quadrotor"})

    layout = learnable.layout_of(learnable.linear_joint())
    with pytest.raises(InputError, match=r"model\.name: 'linear' does not support joint"):
        Known(layout, Known.settings_class(), 0.02)


@every_model
@every_kind
def test_a_step_ahead_beats_the_assumption_that_nothing_changes(name, kind):
    model, _, held = fitted(name, kind)
    errors = rollout_errors(model, held, [1], 500)
    assert any(error["h1"]["model"] < 0.9 * error["h1"]["naive"] for error in errors.values())


@every_model
def test_twins_with_one_seed_are_identical(name):
    recorded = learnable.linear_joint()
    train, validation, _ = learnable.parts_of(recorded)
    twin = learnable.new_model(name, recorded)
    torch.manual_seed(77)  # whatever was drawn before
    loss = twin.fit(train, validation, learnable.QUICK, FitContext(0))
    first, first_loss, _ = fitted(name)
    assert loss == first_loss
    assert all(torch.equal(tensor, first.tensors()[key]) for key, tensor in twin.tensors().items())


@every_model
@every_kind
def test_what_is_loaded_predicts_the_same_bits(name, kind, tmp_path):
    model, _, held = fitted(name, kind)
    model.provenance = Provenance(data="abc", chosen_by="loss", value=0.5, training={"max_epochs": 4})
    save_model(model, tmp_path / "one")
    loaded = load_model(tmp_path / "one")
    states, actions, _ = windows(model, held)
    assert torch.equal(loaded.rollout(states, actions), model.rollout(states, actions))
    assert loaded.provenance == model.provenance
    assert loaded.settings == model.settings
    save_model(loaded, tmp_path / "two")
    for file in (DESCRIPTION_FILE, TENSOR_FILE):
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "two" / file).read_bytes()


@every_model
def test_a_changed_tensor_file_is_refused_in_one_line(name, tmp_path):
    save_model(fitted(name)[0], tmp_path)
    content = bytearray((tmp_path / TENSOR_FILE).read_bytes())
    content[-1] ^= 1
    (tmp_path / TENSOR_FILE).write_bytes(bytes(content))
    with pytest.raises(InputError, match=TENSOR_FILE) as caught:
        load_model(tmp_path)
    assert "\n" not in str(caught.value)


@every_model
def test_tensors_that_do_not_fit_the_settings_are_refused(name, tmp_path):
    save_model(fitted(name)[0], tmp_path)
    change_description(tmp_path, lambda document: document["layout"].update(inputs=["effort", "voltage"]))
    with pytest.raises(InputError, match="has shape"):
        load_model(tmp_path)


def test_loading_executes_nothing(tmp_path):
    save_model(fitted("linear")[0], tmp_path / "model")
    trap = tmp_path / "sprung"

    class Trap:
        def __reduce__(self):
            return Path.touch, (trap,)

    (tmp_path / "model" / TENSOR_FILE).write_bytes(pickle.dumps(Trap()))
    digest = hash_path(tmp_path / "model" / TENSOR_FILE)
    change_description(tmp_path / "model", lambda document: document["tensors"].update(sha256=digest))
    with pytest.raises(InputError, match="is not a safetensors file"):
        load_model(tmp_path / "model")
    text = f"schema: simgap.model/1\nmodel: !!python/object/apply:os.mkdir ['{trap}']\n"
    (tmp_path / "model" / DESCRIPTION_FILE).write_text(text)
    with pytest.raises(InputError, match="is not plain YAML"):
        load_model(tmp_path / "model")
    assert not trap.exists()


@pytest.mark.parametrize(
    ("change", "complaint"),
    [
        (lambda d: d.update(schema="other/1"), "is not of schema"),
        (lambda d: d["model"].update(name="lineal"), "did you mean 'linear'"),
        (lambda d: d["model"].update(sequence_lenght=3), "did you mean 'sequence_length'"),
        (lambda d: d["layout"].update(kind="boat"), "describes no known platform"),
        (lambda d: d.pop("tensors"), "is not a model's description"),
        (lambda d: d.update(time_step="soon"), "is not a model's description"),
        (lambda d: d["provenance"].update(surprise=1), "is not a model's description"),
    ],
)
def test_a_changed_description_is_refused_in_one_line(change, complaint, tmp_path):
    save_model(fitted("linear")[0], tmp_path)
    change_description(tmp_path, change)
    with pytest.raises(InputError, match=complaint) as caught:
        load_model(tmp_path)
    assert "\n" not in str(caught.value)


def test_a_folder_without_a_model_is_refused(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        load_model(tmp_path)


@every_model
def test_a_window_longer_than_every_segment_is_refused(name):
    recorded = learnable.linear_joint(samples=20)
    train, validation, _ = learnable.parts_of(recorded)
    model = learnable.new_model(name, recorded, sequence_length=20)
    with pytest.raises(InputError, match=r"model\.sequence_length: no training segment holds 21 samples"):
        model.fit(train, validation, learnable.QUICK)


def change_description(folder, change):
    path = folder / DESCRIPTION_FILE
    document = yaml.safe_load(path.read_text())
    change(document)
    path.write_text(yaml.safe_dump(document))
