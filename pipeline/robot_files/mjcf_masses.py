"""Masses of an MJCF body: what its inertial says, else its shapes.

mujoco.readthedocs.io, XML reference, `inertial` and `geom`.
"""

from xml.etree.ElementTree import Element

import numpy as np

from simgap.errors import InputError
from simgap.robot_files.bodies import Pose, Solid
from simgap.robot_files.mjcf_settings import Settings, along
from simgap.robot_files.shapes import SIZES, solid_of
from simgap.robot_files.values import number, numbers

_WITHOUT_MASS = ("plane", "hfield")
_DENSITY = 1000.0  # kg/m³, MuJoCo's default

Content = tuple[Element, Pose, str | None]
"""An element in a body, the frame that it is placed in, and the default class for it."""


def masses_of(contents: list[Content], settings: Settings, where: str) -> list[Solid]:
    """Return the masses of a body.

    Args:
        contents: of the body.
        settings: of the file.
        where: the body, to name in an error.

    Raises:
        InputError: when a mass lies in a mesh, or a number is missing.
    """
    inertials = [(element, frame) for element, frame, _ in contents if element.tag == "inertial"]
    if inertials and settings.from_shapes != "true":
        element, frame = inertials[0]
        return [_inertial(element, frame, settings, f"{where}: inertial")]
    if settings.from_shapes == "false":
        return []
    solids = [
        _shape(settings.attributes(element, inherited, where), frame, settings, f"{where}: geom")
        for element, frame, inherited in contents
        if element.tag == "geom"
    ]
    return [solid for solid in solids if solid is not None]


def _inertial(element: Element, frame: Pose, settings: Settings, where: str) -> Solid:
    given = element.attrib
    mass = number(given, "mass", 0.0, where)
    if mass < 0.0:
        raise InputError(f"the mass is negative, {mass:g}", where, "correct the file")
    pose = frame.then(settings.pose(given, where))
    if "fullinertia" in given:
        xx, yy, zz, xy, xz, yz = numbers(given, "fullinertia", "", where, least=6)[:6]
        inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    else:
        inertia = np.diag(numbers(given, "diaginertia", "0 0 0", where, least=3)[:3])
    return Solid(mass, pose.position, pose.rotation @ inertia @ pose.rotation.T)


def _shape(given: dict[str, str], frame: Pose, settings: Settings, where: str) -> Solid | None:
    """Return the mass of a shape; None where it has none."""
    kind = given.get("type", "mesh" if "mesh" in given else "sphere")
    first, last = settings.groups
    if kind in _WITHOUT_MASS or not first <= number(given, "group", 0.0, where) <= last:
        return None
    mass = number(given, "mass", 0.0, where) if "mass" in given else None
    density = number(given, "density", _DENSITY, where)
    if mass == 0.0 or (mass is None and density == 0.0):
        return None
    if kind not in SIZES or "mesh" in given:
        what = "its mass lies in a mesh" if "mesh" in given else f"the mass of a {kind} is not read"
        remedy = "give the body an inertial; MuJoCo writes one with compiler saveinertial (mj_saveLastXML)"
        raise InputError(what, where, remedy)
    if given.get("shellinertia", "false") == "true":
        raise InputError("the inertia of a shell is not read", where, "give the body an inertial")
    pose, size = _placed(given, kind, settings, where)
    pose = frame.then(pose)
    volume, inertia = solid_of(kind, size)
    if volume <= 0.0:
        raise InputError(f"the {kind} has no size", where, "correct the file")
    scale = density if mass is None else mass / volume
    return Solid(scale * volume, pose.position, pose.rotation @ (scale * inertia) @ pose.rotation.T)


def _placed(given: dict[str, str], kind: str, settings: Settings, where: str) -> tuple[Pose, np.ndarray]:
    """Return pose and size of a shape; with `fromto`, the ends of its long axis, it has one size across."""
    if "fromto" not in given or kind == "sphere":
        return settings.pose(given, where), numbers(given, "size", "", where, least=SIZES[kind])
    ends = numbers(given, "fromto", "", where, least=6)[:6].reshape(2, 3)
    half = 0.5 * (ends[1] - ends[0])
    across = np.repeat(numbers(given, "size", "", where)[0], SIZES[kind] - 1)
    size = np.append(across, np.linalg.norm(half))
    return Pose(ends.mean(axis=0), along(half, where)), size
