"""The checkpoint folder of an interrupted training."""

import shutil
from contextlib import suppress
from pathlib import Path
from typing import Any

from simgap.artifacts.hashing import hash_value

_FOLDER = "checkpoints"


def checkpoint_folder(artifacts: str | Path, identity: Any) -> Path:
    """Return the folder of a training's checkpoint.

    Args:
        artifacts: the directory of the branch's artifacts.
        identity: settings, seed and inputs; a training with the same ones finds the same folder.
    """
    return Path(artifacts) / _FOLDER / hash_value(identity)[:16]


def remove_checkpoint(folder: Path) -> None:
    """Remove the checkpoint of a training that is done."""
    shutil.rmtree(folder, ignore_errors=True)
    with suppress(OSError):  # another training may have its checkpoint beside
        folder.parent.rmdir()
