"""Robot files for the tests, written out of a few numbers."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from simgap.robot_files import read_robot_file

ROD = """<robot name="rod">
  <link name="base"/>
  <link name="rod">
    <inertial>
      <origin xyz="0 0 {center}"/>
      <mass value="{mass}"/>
      <inertia ixx="{across}" iyy="{across}" izz="0" ixy="0" ixz="0" iyz="0"/>
    </inertial>
  </link>
  <joint name="hinge" type="{kind}">
    <parent link="base"/>
    <child link="rod"/>
    <origin xyz="0.3 -0.2 1.0" rpy="{rpy}"/>
    <axis xyz="{axis}"/>
    <limit lower="-1" upper="1" effort="{effort}" velocity="5"/>
    {more}
  </joint>
</robot>"""


def rod(
    mass: float = 0.6,
    length: float = 0.5,
    kind: str = "continuous",
    rpy: str = "0 0 0",
    axis: str = "0 1 0",
    effort: float = 0.0,
    more: str = "",
) -> str:
    """Return the URDF of a thin uniform rod that hangs from a joint at its upper end."""
    across = mass * length**2 / 12.0
    return ROD.format(
        mass=mass, center=-length / 2, across=across, kind=kind, rpy=rpy, axis=axis, effort=effort, more=more
    )


def mjcf(world: str, before: str = "", after: str = "") -> str:
    """Return an MJCF document around the bodies of the world."""
    return f'<mujoco><compiler angle="radian"/>{before}<worldbody>{world}</worldbody>{after}</mujoco>'


def keys(text: str, folder: Path, joint: str | None = None, name: str = "robot.xml") -> dict[str, Any]:
    """Return the keys that a robot file of this text gives for a joint."""
    (folder / name).write_text(text, encoding="utf-8")
    return read_robot_file(folder / name, joint)


def written(values: Sequence[float] | np.ndarray) -> str:
    """Return numbers as an attribute with all their digits."""
    return " ".join(repr(float(value)) for value in values)
