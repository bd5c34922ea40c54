from dataclasses import replace

import numpy as np
import onnxruntime
import pytest
import torch
import yaml

from simgap.errors import InputError
from simgap.perception.detector import Detector, Maps, check_size
from simgap.perception.learning import Learning
from simgap.perception.storage import (
    DESCRIPTION_FILE,
    HALF_FILE,
    ONNX_FILE,
    TENSOR_FILE,
    export_detector,
    load_detector,
    save_detector,
)
from tests.pipeline.perception.eyes import perception

SIZE = (64, 96)  # px


def small_settings():
    """Return the settings of small images, of two each step."""
    settings = perception()
    learning = replace(settings.detector.learning, batch=2)
    camera = replace(settings.camera, image=[64, 64])
    images = replace(settings.images, exposures=2, clutter=2)
    return replace(
        settings, camera=camera, images=images, detector=replace(settings.detector, learning=learning)
    )


def network(seed: int = 0) -> Detector:
    torch.manual_seed(seed)
    return Detector(perception().detector).eval()


def images(count: int = 2) -> torch.Tensor:
    return torch.rand(count, 1, SIZE[1], SIZE[0], generator=torch.Generator().manual_seed(1))


def test_filters_and_sizes_are_those_that_are_published():
    levels = [part[0] for part in network().down]
    assert [layer.out_channels for layer in levels] == [8, 16, 16, 16, 16, 16]
    assert [layer.kernel_size[0] for layer in levels] == [3, 3, 3, 5, 7, 7]
    assert network().last.out_channels == 12


def test_a_map_has_the_size_of_its_image():
    assert Maps(network())(images()).shape == (2, 12, SIZE[1], SIZE[0])


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"kernels": [3, 3]}, r"perception\.detector\.kernels: needs one size for each level"),
        ({"kernels": [3, 3, 3, 5, 7, 4]}, r"perception\.detector\.kernels: a filter has no middle pixel"),
    ],
)
def test_levels_that_cannot_be_are_refused(changed, message):
    with pytest.raises(InputError, match=message):
        Detector(replace(perception().detector, **changed))


def test_an_image_that_cannot_be_halved_is_refused():
    with pytest.raises(InputError, match=r"400 × 384 cannot be halved at every level.*multiples of 32"):
        check_size((400, 384), perception().detector)


def test_what_is_written_is_read_again(tmp_path):
    written = network(3)
    save_detector(written, perception(), {"seed": 3}, tmp_path)
    read, settings = load_detector(tmp_path)
    assert settings == perception()
    assert torch.equal(read(images()), written(images()))


def test_the_same_detector_gives_the_same_bytes(tmp_path):
    for folder in ("one", "two"):
        save_detector(network(3), perception(), {}, tmp_path / folder)
    for file in (DESCRIPTION_FILE, TENSOR_FILE):
        assert (tmp_path / "one" / file).read_bytes() == (tmp_path / "two" / file).read_bytes()


def test_numbers_of_another_detector_are_refused(tmp_path):
    save_detector(network(), perception(), {}, tmp_path)
    save_detector(network(1), perception(), {}, tmp_path / "other")
    (tmp_path / TENSOR_FILE).write_bytes((tmp_path / "other" / TENSOR_FILE).read_bytes())
    with pytest.raises(InputError, match="is not the file that the description belongs to"):
        load_detector(tmp_path)


def test_a_description_with_an_unknown_key_is_refused(tmp_path):
    save_detector(network(), perception(), {}, tmp_path)
    document = yaml.safe_load((tmp_path / DESCRIPTION_FILE).read_text())
    document["perception"]["detector"]["lens"] = 1
    (tmp_path / DESCRIPTION_FILE).write_text(yaml.safe_dump(document))
    with pytest.raises(InputError, match="is not a detector's description"):
        load_detector(tmp_path)


@pytest.mark.parametrize(
    ("file", "kind", "limit"), [(ONNX_FILE, np.float32, 1e-4), (HALF_FILE, np.float16, 2e-2)]
)
def test_the_exported_network_gives_the_same_maps(tmp_path, file, kind, limit):
    written = network(2)
    export_detector(written, SIZE, tmp_path)
    session = onnxruntime.InferenceSession(str(tmp_path / file), providers=["CPUExecutionProvider"])
    (maps,) = session.run(None, {"images": images().numpy().astype(kind)})
    with torch.no_grad():
        wanted = Maps(written)(images()).numpy()
    np.testing.assert_allclose(maps.astype(np.float32), wanted, atol=limit)


def learned(steps: int, seed: int = 0) -> tuple[Learning, float]:
    """Return what some steps on the same images lead to, and the share of the loss that is left."""
    torch.manual_seed(seed)
    settings = small_settings()
    module = Learning(Detector(settings.detector), settings, seed)
    module.on_fit_start()
    examples = module.examples(0)
    optimizer = torch.optim.Adam(module.parameters(), lr=3e-3)
    losses = []
    for _ in range(steps):
        loss = module.loss(*examples)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
        losses.append(loss.item())
    return module, losses[-1] / losses[0]


def test_a_detector_learns_what_it_is_shown():
    assert learned(25)[1] < 0.5


def test_images_of_a_step_depend_on_seed_and_step():
    settings = small_settings()
    modules = [Learning(Detector(settings.detector), settings, seed) for seed in (0, 0, 1)]
    for module in modules:
        module.on_fit_start()
    first, again, other = (module.examples(3) for module in modules)
    assert all(torch.equal(*pair) for pair in zip(first, again, strict=True))
    assert not torch.equal(first[0], other[0])
    assert not torch.equal(first[0], modules[0].examples(4)[0])


def test_steps_are_numbered_on_through_the_epochs_and_apart_from_validation():
    settings = small_settings()
    module = Learning(Detector(settings.detector), settings, 0)
    steps = settings.detector.learning.steps
    assert module.train_dataloader() == range(steps)
    assert not set(module.val_dataloader()) & set(range(10**6))
