"""Floor 0: atomic writes, hashes of artifacts, progress of long work."""

from simgap.artifacts.atomic import staged_directory
from simgap.artifacts.checkpoints import checkpoint_folder, remove_checkpoint
from simgap.artifacts.hashing import hash_path, hash_value
from simgap.artifacts.progress import Pace, progress
from simgap.artifacts.project import CHECKOUT, CONFIGURATION, PACKAGE, PROJECT_ROOT, STAGES, require_checkout

__all__ = [
    "CHECKOUT",
    "CONFIGURATION",
    "PACKAGE",
    "PROJECT_ROOT",
    "STAGES",
    "Pace",
    "checkpoint_folder",
    "hash_path",
    "hash_value",
    "progress",
    "remove_checkpoint",
    "require_checkout",
    "staged_directory",
]
