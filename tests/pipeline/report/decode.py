"""Read back what `simgap.report.figure.encode` wrote."""

import base64

import numpy as np


def decode(coded: dict[str, str]) -> np.ndarray:
    """Return the numbers, shape (n,) or (rows, columns)."""
    values = np.frombuffer(base64.b64decode(coded["bdata"]), dtype=coded["dtype"])
    return values.reshape([int(size) for size in coded["shape"].split(",")]) if "shape" in coded else values
