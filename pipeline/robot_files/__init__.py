"""Floor 0: robot files (URDF and MJCF), read as what a platform says of one joint."""

from simgap.robot_files.read import SUFFIXES, is_robot_file, read_robot_file

__all__ = ["SUFFIXES", "is_robot_file", "read_robot_file"]
