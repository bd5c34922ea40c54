"""A readable YAML description with numbers in safetensors files, whose hashes it holds.

Reading executes nothing.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml
from safetensors import SafetensorError
from safetensors.torch import load as tensors_from_bytes
from safetensors.torch import save as tensors_to_bytes
from torch import Tensor

from simgap.artifacts.hashing import hash_path
from simgap.errors import InputError


def write_description(document: Mapping[str, Any], path: Path) -> None:
    """Write a plain mapping as YAML, its keys in their order."""
    path.write_text(yaml.safe_dump(dict(document), sort_keys=False, allow_unicode=True), encoding="utf-8")


def read_description(path: Path, schema: str, source: str, remedy: str) -> dict[str, Any]:
    """Read a description.

    Args:
        path: of the file.
        schema: that it has to be of.
        source: what to give where there is no such file.
        remedy: what to do where it is damaged.

    Raises:
        InputError: when it cannot be read, is not plain YAML or of another schema.
    """
    try:
        document = yaml.safe_load(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror})", str(path), source) from error
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise InputError("is not plain YAML", str(path), remedy) from error
    if not isinstance(document, dict) or document.get("schema") != schema:
        raise InputError(f"is not of schema {schema}", str(path), remedy)
    return document


def write_tensors(tensors: Mapping[str, Tensor], file: Path) -> dict[str, str]:
    """Write numbers and return what a description says of the file; the same numbers give the same bytes."""
    plain = {name: tensors[name].detach().cpu().contiguous() for name in sorted(tensors)}
    file.write_bytes(tensors_to_bytes(plain))
    return {"file": file.name, "sha256": hash_path(file)}


def read_tensors(file: Path, described: object, remedy: str) -> dict[str, Tensor]:
    """Read numbers that `write_tensors` wrote.

    Args:
        file: of the numbers.
        described: what it returned, as a description that anybody may have changed has it.
        remedy: what to do where it is damaged.

    Raises:
        InputError: when the file is missing, another one than described, or no safetensors.
    """
    expected = described.get("sha256") if isinstance(described, Mapping) else None
    if not file.exists() or hash_path(file) != expected:
        raise InputError("is not the file that the description belongs to", str(file), remedy)
    try:
        return dict(tensors_from_bytes(file.read_bytes()))
    except SafetensorError as error:
        raise InputError("is not a safetensors file", str(file), remedy) from error
