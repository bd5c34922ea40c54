"""From a robot file and the name of a joint to the keys of a platform."""

from pathlib import Path
from typing import TYPE_CHECKING, Any

from simgap.errors import InputError

if TYPE_CHECKING:
    from simgap.robot_files.bodies import Robot

SUFFIXES = (".urdf", ".xml", ".mjcf")


def is_robot_file(path: str | Path) -> bool:
    """Whether a path is that of a robot file, by its suffix."""
    return Path(path).suffix.lower() in SUFFIXES


def read_robot_file(path: Path, joint: str | None = None) -> dict[str, Any]:
    """Return the keys of docs/contract.md for one joint of a robot, with what was assumed as sentences.

    Args:
        path: a URDF or MJCF file.
        joint: its name; None for the only one that moves.

    Raises:
        InputError: when the file cannot be read or trusted, or there is no such joint.
    """
    from simgap.robot_files.joint_keys import joint_keys

    return joint_keys(_read(path), joint)


def _read(path: Path) -> "Robot":
    from simgap.robot_files.document import read_document
    from simgap.robot_files.mjcf import read_mjcf
    from simgap.robot_files.urdf import read_urdf

    root = read_document(path)
    readers = {"robot": read_urdf, "mujoco": read_mjcf}
    if root.tag not in readers:
        raise InputError(
            f"begins with <{root.tag}>", str(path), "give a URDF (<robot>) or an MJCF (<mujoco>)"
        )
    return readers[root.tag](root, str(path))
