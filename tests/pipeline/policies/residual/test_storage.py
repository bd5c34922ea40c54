import pytest
import torch
import yaml

from simgap.errors import InputError
from simgap.policies.residual.gaussian_processes import fit
from simgap.policies.residual.realisations import draw
from simgap.policies.residual.storage import (
    DESCRIPTION_FILE,
    TENSOR_FILE,
    load_observation,
    save_observation,
)
from simgap.policies.residual.wander import Course


@pytest.fixture
def saved(tmp_path):
    random = torch.Generator().manual_seed(0)
    features, residual = torch.randn(40, 15, generator=random), torch.randn(40, 9, generator=random)
    course = Course(torch.arange(40) // 20, 0.1 * (torch.arange(40) % 20).double())
    processes = fit(features, residual, course, judged_by=20, iterations=3)
    drawn = draw(processes, count=4, waves=16, anchors=10, seed=0)
    save_observation(processes, drawn, "a flight", tmp_path)
    return drawn, tmp_path


def test_draws_are_read_as_they_were_written(saved):
    drawn, folder = saved
    asked = torch.randn(6, 15), torch.rand(6), torch.arange(6) % 4
    assert torch.equal(load_observation(folder)(*asked), drawn(*asked))
    described = yaml.safe_load((folder / DESCRIPTION_FILE).read_text())
    assert described["draws"] == 4
    assert described["source"] == "a flight"


def test_what_is_damaged_is_refused_in_one_line(saved):
    _, folder = saved
    whole = (folder / TENSOR_FILE).read_bytes()
    for damage in (whole[:-10], b"", b"\x80\x04."):
        (folder / TENSOR_FILE).write_bytes(damage)
        with pytest.raises(InputError, match="belongs to"):
            load_observation(folder)
    (folder / DESCRIPTION_FILE).write_text("schema: other\ntensors: {sha256: x}\n")
    with pytest.raises(InputError, match="is not of schema"):
        load_observation(folder)
    with pytest.raises(InputError, match="cannot be read"):
        load_observation(folder / "nowhere")
