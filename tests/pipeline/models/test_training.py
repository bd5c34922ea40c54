import pytest
import torch

from simgap.errors import InputError
from simgap.models.contract import FitContext
from simgap.models.settings import Training
from tests.pipeline.models import learnable


class Killed(Exception):
    pass


def kill_at(epoch):
    def log(metrics, step):
        if step == epoch:
            raise Killed

    return log


@pytest.fixture(scope="module")
def parts():
    recorded = learnable.linear_joint()
    return recorded, *learnable.parts_of(recorded)


@pytest.mark.parametrize("name", ["fnn", "lstm", "tcn"])
@pytest.mark.parametrize("epoch", [0, 1, 4])
def test_a_killed_training_goes_on_to_the_same_end(name, epoch, parts, tmp_path):
    recorded, train, validation, _ = parts
    training = Training(max_epochs=5, batch_size=128)
    undisturbed, resumed = (learnable.new_model(name, recorded, dropout=[0.2]) for _ in range(2))
    loss = undisturbed.fit(train, validation, training, FitContext(3))
    with pytest.raises(Killed):
        resumed.fit(train, validation, training, FitContext(3, tmp_path, kill_at(epoch)))
    epochs = []
    again = learnable.new_model(name, recorded, dropout=[0.2])
    context = FitContext(3, tmp_path, lambda metrics, step: epochs.append(step))
    assert again.fit(train, validation, training, context) == loss
    assert epochs == list(range(epoch, 5))
    assert all(torch.equal(tensor, again.tensors()[key]) for key, tensor in undisturbed.tensors().items())


def test_a_training_that_had_stopped_early_stops_there_again(parts, tmp_path):
    recorded, train, validation, _ = parts
    training = Training(max_epochs=200, patience=1, batch_size=128)
    epochs, repeated = [], []
    first = learnable.new_model("fnn", recorded, learning_rate=0.1)
    loss = first.fit(train, validation, training, FitContext(0, tmp_path, lambda m, s: epochs.append(s)))
    assert len(epochs) < 200
    second = learnable.new_model("fnn", recorded, learning_rate=0.1)
    context = FitContext(0, tmp_path, lambda m, s: repeated.append(s))
    assert second.fit(train, validation, training, context) == loss
    assert repeated == epochs[-1:]


def test_the_weights_of_the_best_epoch_are_kept(parts):
    recorded, train, validation, _ = parts
    losses = []
    training = Training(max_epochs=8, patience=8, batch_size=128)
    model = learnable.new_model("fnn", recorded, learning_rate=0.05)
    context = FitContext(0, None, lambda metrics, step: losses.append(metrics["validation_loss"]))
    assert model.fit(train, validation, training, context) == min(losses)
    assert losses.index(min(losses)) != 0


def test_a_diverging_training_says_so(parts):
    recorded, train, validation, _ = parts
    model = learnable.new_model("fnn", recorded, learning_rate=1e30)
    with pytest.raises(InputError, match=r"model\.learning_rate: the training diverges"):
        model.fit(train, validation, Training(max_epochs=2, batch_size=128))


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        ({"hidden": [0]}, r"model\.hidden"),
        ({"dropout": [1.0]}, r"model\.dropout"),
        ({"dropout": [0.1, 0.1]}, r"model\.dropout"),
        ({"scaling": "max"}, r"model\.scaling"),
        ({"sequence_length": 0}, r"model\.sequence_length"),
    ],
)
def test_settings_that_make_no_network_are_refused(options, complaint, parts):
    recorded, train, validation, _ = parts
    with pytest.raises(InputError, match=complaint):
        learnable.new_model("lstm", recorded, **options).fit(train, validation, learnable.QUICK)
