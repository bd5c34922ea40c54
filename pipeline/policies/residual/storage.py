"""A residual of observations on disk: `observation.yaml` for people, `observation.safetensors` for numbers."""

from pathlib import Path

from simgap.artifacts.descriptions import (
    read_description,
    read_tensors,
    write_description,
    write_tensors,
)
from simgap.errors import InputError
from simgap.policies.residual.beliefs import RESIDUALS
from simgap.policies.residual.gaussian_processes import GaussianProcesses
from simgap.policies.residual.realisations import Realisations

SCHEMA = "simgap.observation/2"
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
    size = processes.output_scale[1]
    described = {
        name: {
            "standard_deviation": float(size[place]),
            "share_in_time": float(processes.wander.variance[place]),
            "time_scale": round(float(processes.wander.time[place]), 3),
            "share_of_noise": float(processes.noise[place]),
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
        "tensors": write_tensors(drawn.tensors(), folder / TENSOR_FILE),
    }
    write_description(document, folder / DESCRIPTION_FILE)


def load_observation(folder: Path) -> Realisations:
    """Read what `save_observation` wrote; nothing is executed.

    Raises:
        InputError: when a file is missing, or is not what it should be.
    """
    document = read_description(folder / DESCRIPTION_FILE, SCHEMA, _REMEDY, _REMEDY)
    tensors = read_tensors(folder / TENSOR_FILE, document.get("tensors", {}), _REMEDY)
    try:
        return Realisations(**tensors)
    except TypeError as error:
        raise InputError(f"holds other numbers ({error})", str(folder / TENSOR_FILE), _REMEDY) from error
