"""Floor 0: files that are whole or not there, hashed, and long work that shows how far it is."""

from pipeline.artifacts.atomic import staged_directory
from pipeline.artifacts.checkpoints import checkpoint_folder, remove_checkpoint
from pipeline.artifacts.hashing import hash_path, hash_value
from pipeline.artifacts.progress import Pace, progress
from pipeline.artifacts.project import PROJECT_ROOT

__all__ = [
    "PROJECT_ROOT",
    "Pace",
    "checkpoint_folder",
    "hash_path",
    "hash_value",
    "progress",
    "remove_checkpoint",
    "staged_directory",
]
