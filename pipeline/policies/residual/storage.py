"""A residual of observations on disk: `observation.yaml` for people, `observation.safetensors` for numbers."""

from pathlib import Path

import torch
import yaml
from safetensors import SafetensorError
from safetensors.torch import load as tensors_from_bytes
from safetensors.torch import save as tensors_to_bytes

from pipeline.artifacts import hash_path
from pipeline.errors import InputError
from pipeline.policies.residual.beliefs import RESIDUALS
from pipeline.policies.residual.gaussian_processes import GaussianProcesses
from pipeline.policies.residual.realisations import Realisations

SCHEMA = "simgap.observation/1"
DESCRIPTION_FILE, TENSOR_FILE = "observation.yaml", "observation.safetensors"
_REMEDY = "give the folder that simgap identify_residual wrote"


def save_observation(processes: GaussianProcesses, drawn: Realisations, source: str, folder: Path) -> None:
    """Write drawn residuals and what they were drawn from.

    Args:
        processes: fitted.
        drawn: from them.
        source: of the recording.
        folder: is made if needed.
    """
    folder.mkdir(parents=True, exist_ok=True)
    (folder / TENSOR_FILE).write_bytes(tensors_to_bytes(drawn.tensors()))
    size = processes.output_scale[1]
    described = {
        name: {
            "standard_deviation": float(size[place]),
            "share_explained": float(1.0 - processes.noise[place]),
            "length_scales": [round(float(length), 3) for length in processes.lengths[place]],
        }
        for place, name in enumerate(RESIDUALS)
    }
    document = {
        "schema": SCHEMA,
        "source": source,
        "samples": len(processes.inputs),
        "draws": len(drawn),
        "residuals": described,
        "tensors": {"file": TENSOR_FILE, "sha256": hash_path(folder / TENSOR_FILE)},
    }
    text = yaml.safe_dump(document, sort_keys=False, allow_unicode=True)
    (folder / DESCRIPTION_FILE).write_text(text, encoding="utf-8")


def load_observation(folder: Path) -> Realisations:
    """Read what `save_observation` wrote; nothing is executed.

    Raises:
        InputError: when a file is missing, or is not what it should be.
    """
    described, tensors = folder / DESCRIPTION_FILE, folder / TENSOR_FILE
    try:
        document = yaml.safe_load(described.read_text(encoding="utf-8"))
        expected = document["tensors"]["sha256"] if document["schema"] == SCHEMA else ""
        if hash_path(tensors) != expected:
            raise ValueError(f"{tensors.name} is not the file that it belongs to")
        read: dict[str, torch.Tensor] = tensors_from_bytes(tensors.read_bytes())
        return Realisations(**read)
    except (OSError, KeyError, TypeError, ValueError, yaml.YAMLError, SafetensorError) as error:
        raise InputError(f"cannot be read ({error})", str(described), _REMEDY) from error
