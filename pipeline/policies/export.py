"""Export of a policy to ONNX and TorchScript."""

import warnings
from pathlib import Path

import torch

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
        warnings.simplefilter("ignore")  # both ways of writing are old; the files are what is asked for
        torch.jit.trace(policy, example).save(str(folder / SCRIPT_FILE))
        torch.onnx.export(
            policy,
            (example,),
            str(folder / ONNX_FILE),
            input_names=["observation"],
            output_names=["action"],
            dynamic_axes={"observation": {0: "batch"}, "action": {0: "batch"}},
            dynamo=False,
        )
