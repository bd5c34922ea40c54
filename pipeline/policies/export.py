"""Export of a policy to ONNX and TorchScript."""

import warnings
from pathlib import Path

import torch

from simgap.artifacts.onnx_file import write_onnx
from simgap.policies.networks import Gaussian, Policy

ONNX_FILE = "policy.onnx"
SCRIPT_FILE = "policy.torchscript"


def export_policy(gaussian: Gaussian, folder: Path) -> None:
    """Write the most likely action, (batch, action_size), as a function of `observation` (batch, observation_size).

    Args:
        gaussian: of the policy.
        folder: takes `policy.onnx` and `policy.torchscript`.
    """
    policy = Policy(gaussian).cpu().eval()
    size = next(policy.parameters()).shape[1]
    example = torch.zeros(2, size)
    with warnings.catch_warnings(), torch.no_grad():
        warnings.simplefilter("ignore")  # this way of writing is old; the file is what is asked for
        torch.jit.trace(policy, example).save(str(folder / SCRIPT_FILE))
    write_onnx(policy, example, folder / ONNX_FILE, "observation", "action")
