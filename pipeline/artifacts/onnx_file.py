"""Networks as ONNX files, which other programs run."""

import warnings
from pathlib import Path

import torch
from torch import Tensor, nn


def write_onnx(network: nn.Module, example: Tensor, path: Path, given: str, found: str) -> None:
    """Write a network of one input and one output, whose first dimension is free.

    Args:
        network: to write.
        example: of the input, (batch, ...).
        path: of the file.
        given: name of the input.
        found: name of the output.
    """
    with warnings.catch_warnings(), torch.no_grad():
        warnings.simplefilter("ignore")  # this way of writing is old; the file is what is asked for
        torch.onnx.export(
            network,
            (example,),
            str(path),
            input_names=[given],
            output_names=[found],
            dynamic_axes={given: {0: "batch"}, found: {0: "batch"}},
            dynamo=False,
        )
