"""URDF: links and joints side by side (wiki.ros.org/urdf/XML, link and joint)."""

from collections.abc import Callable
from xml.etree.ElementTree import Element

import numpy as np

from simgap.errors import InputError
from simgap.robot_files.bodies import Axis, Body, Pose, Robot, Solid
from simgap.robot_files.values import direction, number, vector

_MOVING = {"revolute": False, "continuous": False, "prismatic": True}  # whether it slides
_MOMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


def read_urdf(root: Element, file: str) -> Robot:
    """Return the robot of a URDF document.

    Raises:
        InputError: when a joint names a link that is not there, a link has two joints above it, or links form a loop.
    """
    bodies = {
        _name(link, f"{file}: link"): Body(_name(link, file), Pose(), _solids(link, file))
        for link in root.findall("link")
    }
    carried: set[str] = set()
    for joint in root.findall("joint"):
        where = f"{file}: joint {_name(joint, f'{file}: joint')!r}"
        outer, inner = (_link(joint, role, bodies, where) for role in ("parent", "child"))
        if inner in carried:
            raise InputError(f"link {inner!r} is moved by two joints", where, "a URDF is a tree")
        carried.add(inner)
        bodies[inner].pose = _pose(joint.find("origin"), where)
        bodies[inner].axes = _axes(joint, where)
        bodies[outer].inner.append(bodies[inner])
    standing = [body for name, body in bodies.items() if name not in carried]
    if sum(1 for body in standing for _ in body.walk(Pose())) < len(bodies):
        raise InputError("links form a loop", file, "a URDF is a tree")
    return Robot(file, standing)


def _name(element: Element, where: str) -> str:
    name = element.get("name")
    if not name:
        raise InputError(f"<{element.tag}> has no name", where, "correct the file")
    return name


def _link(joint: Element, role: str, bodies: dict[str, Body], where: str) -> str:
    element = joint.find(role)
    name = "" if element is None else element.get("link", "")
    if name not in bodies:
        raise InputError(f"the {role} link {name!r} is not there", where, "correct the file")
    return name


def _pose(origin: Element | None, where: str) -> Pose:
    if origin is None:
        return Pose()
    from scipy.spatial.transform import Rotation

    angles = vector(origin.attrib, "rpy", "0 0 0", where)
    return Pose(vector(origin.attrib, "xyz", "0 0 0", where), Rotation.from_euler("xyz", angles).as_matrix())


def _axes(joint: Element, where: str) -> list[Axis]:
    kind = joint.get("type")
    if kind not in _MOVING:
        return []
    pointing, limit, dynamics = joint.find("axis"), _child(joint, "limit"), _child(joint, "dynamics")
    effort = number(limit, "effort", 0.0, where)
    axis = Axis(
        name=joint.get("name", ""),
        slides=_MOVING[kind],
        direction=direction({} if pointing is None else pointing.attrib, "xyz", "1 0 0", where),
        damping=number(dynamics, "damping", 0.0, where),
        friction=number(dynamics, "friction", 0.0, where),
        effort_limit=effort if effort > 0.0 else None,
    )
    if joint.find("mimic") is not None:
        axis.remarks.append("It mimics another joint, which is not taken into account.")
    return [axis]


def _child(joint: Element, tag: str) -> dict[str, str]:
    element = joint.find(tag)
    return {} if element is None else element.attrib


def _solids(link: Element, file: str) -> Callable[[], list[Solid]]:
    return lambda: _inertial(link, f"{file}: link {link.get('name')!r}")


def _inertial(link: Element, where: str) -> list[Solid]:
    inertial = link.find("inertial")
    if inertial is None:
        return []
    mass, moments = inertial.find("mass"), _child(inertial, "inertia")
    pose = _pose(inertial.find("origin"), where)
    xx, yy, zz, xy, xz, yz = (number(moments, key, 0.0, where) for key in _MOMENTS)
    inertia = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    weight = number({} if mass is None else mass.attrib, "value", 0.0, where)
    if weight < 0.0:
        raise InputError(f"the mass is negative, {weight:g}", where, "correct the file")
    return [Solid(weight, pose.position, pose.rotation @ inertia @ pose.rotation.T)]
