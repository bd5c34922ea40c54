"""A detector on disk: `detector.yaml` for people, `detector.safetensors` for numbers. Loading executes nothing.

Beside them stands the network as ONNX, in single and in half precision: from `images` (batch, 1, height, width) between
0 and 1 to `maps` (batch, 12, height, width), as `simgap.perception.maps` orders them.
"""

import copy
from dataclasses import asdict
from pathlib import Path
from typing import Any

import torch
from omegaconf import OmegaConf
from omegaconf.errors import OmegaConfBaseException

from simgap.artifacts.descriptions import read_description, read_tensors, write_description, write_tensors
from simgap.artifacts.onnx_file import write_onnx
from simgap.errors import InputError
from simgap.perception.detector import Detector, Maps
from simgap.perception.settings import PerceptionSettings

SCHEMA = "simgap.detector/1"
DESCRIPTION_FILE = "detector.yaml"
TENSOR_FILE = "detector.safetensors"
ONNX_FILE = "detector.onnx"
HALF_FILE = "detector_half.onnx"
_SOURCE = "give the folder of a detector, as simgap train_detector writes it"
_REMEDY = "train the detector again"


def save_detector(
    network: Detector, settings: PerceptionSettings, trained: dict[str, Any], folder: Path
) -> None:
    """Write a detector into a folder; the same detector gives the same bytes.

    Args:
        network: to write.
        settings: it was trained with.
        trained: what else is to be said of the training.
        folder: takes the files.
    """
    folder.mkdir(parents=True, exist_ok=True)
    stored = write_tensors(network.state_dict(), folder / TENSOR_FILE)
    document = {"schema": SCHEMA, "perception": asdict(settings), "trained": trained, "tensors": stored}
    write_description(document, folder / DESCRIPTION_FILE)


def load_detector(folder: Path) -> tuple[Detector, PerceptionSettings]:
    """Read a detector that `save_detector` wrote, and the settings that it was trained with.

    Raises:
        InputError: when a file is missing, is not what it should be, or does not fit the other.
    """
    path = folder / DESCRIPTION_FILE
    document = read_description(path, SCHEMA, _SOURCE, _REMEDY)
    try:
        merged = OmegaConf.merge(OmegaConf.structured(PerceptionSettings), document["perception"])
        settings = OmegaConf.to_object(merged)
        assert isinstance(settings, PerceptionSettings)
        network = Detector(settings.detector)
        network.load_state_dict(read_tensors(folder / TENSOR_FILE, document["tensors"], _REMEDY))
    except (KeyError, TypeError, ValueError, RuntimeError, OmegaConfBaseException) as error:
        what = " ".join(str(error).split())
        raise InputError(f"is not a detector's description ({what})", str(path), _REMEDY) from error
    return network.eval(), settings


def export_detector(network: Detector, size: tuple[int, int], folder: Path) -> None:
    """Write a detector as ONNX, in both precisions.

    Args:
        network: to write.
        size: width and height of its images, px.
        folder: takes the files.
    """
    for file, precision in ((ONNX_FILE, torch.float32), (HALF_FILE, torch.float16)):
        maps = Maps(copy.deepcopy(network)).cpu().eval().to(precision)
        example = torch.zeros(1, 1, size[1], size[0], dtype=precision)
        write_onnx(maps, example, folder / file, "images", "maps")
