"""MJCF: bodies in one another (mujoco.readthedocs.io, XML reference, section worldbody)."""

from collections.abc import Callable, Iterator
from xml.etree.ElementTree import Element

import numpy as np

from simgap.errors import InputError
from simgap.robot_files.bodies import Axis, Body, Pose, Robot, Solid
from simgap.robot_files.mjcf_actuators import add_actuators
from simgap.robot_files.mjcf_masses import masses_of
from simgap.robot_files.mjcf_settings import Settings, read_settings
from simgap.robot_files.values import direction, number, numbers, vector

_UNREAD = ("include", "attach", "replicate", "composite", "flexcomp")  # bodies that are not written out
_COUPLED = ("connect", "weld", "joint", "tendon")


def read_mjcf(root: Element, file: str) -> Robot:
    """Return the robot of an MJCF document.

    Raises:
        InputError: on bodies that are not written out, an unknown default class and a wrong number.
    """
    for tag in _UNREAD:
        if next(root.iter(tag), None) is not None:
            remedy = "let MuJoCo write the whole model (mj_saveLastXML) and give that file"
            raise InputError(f"<{tag}> is not read", file, remedy)
    settings = read_settings(root, file)
    bodies = [
        body for world in root.findall("worldbody") for body in _Reader(settings).bodies(world, Pose(), None)
    ]
    robot = Robot(file, bodies, settings.gravity)
    if settings.total_mass > 0.0:
        settings.scale = _scale(robot, settings.total_mass)
    axes = {axis.name: axis for axis, _, _ in robot.axes()}
    add_actuators(root, settings, axes)
    for equality in (entry for section in root.findall("equality") for entry in section):
        if equality.tag in _COUPLED:
            for axis in axes.values():
                axis.remarks.append("The equality constraints of the file are not taken into account.")
            break
    return robot


def _scale(robot: Robot, total_mass: float) -> float:
    """Return what makes the masses of all bodies a total; the bodies are read for it as they are."""
    masses = [solid.mass for root in robot.bodies for body, _ in root.walk(Pose()) for solid in body.solids()]
    if sum(masses) <= 0.0:
        raise InputError("settotalmass is given, and nothing has a mass", robot.file, "correct the file")
    return total_mass / sum(masses)


class _Reader:
    """Reads bodies, each with the class that those around it set."""

    def __init__(self, settings: Settings) -> None:
        self.settings = settings

    def bodies(self, element: Element, frame: Pose, inherited: str | None) -> list[Body]:
        """Return the bodies directly in an element.

        Args:
            element: a body or the world.
            frame: in which they are placed.
            inherited: the default class for them.
        """
        return [
            self._body(child, pose, passed)
            for child, pose, passed in self._contents(element, frame, inherited)
            if child.tag == "body"
        ]

    def _contents(
        self, element: Element, frame: Pose, inherited: str | None
    ) -> Iterator[tuple[Element, Pose, str | None]]:
        """Yield what is in an element, what is in its frames included, each with its frame and class."""
        for child in element:
            if child.tag == "frame":
                where = f"{self.settings.file}: frame"
                inner = frame.then(self.settings.pose(child.attrib, where))
                yield from self._contents(child, inner, child.get("childclass") or inherited)
            else:
                yield child, frame, inherited

    def _body(self, element: Element, frame: Pose, inherited: str | None) -> Body:
        name = element.get("name", "without a name")
        where = f"{self.settings.file}: body {name!r}"
        passed = element.get("childclass") or inherited
        contents = list(self._contents(element, Pose(), passed))
        body = Body(
            name,
            frame.then(self.settings.pose(element.attrib, where)),
            self._solids(contents, where),
            [axis for child, pose, own in contents for axis in self._axes(child, pose, own, where)],
        )
        body.inner = self.bodies(element, Pose(), passed)
        return body

    def _solids(
        self, contents: list[tuple[Element, Pose, str | None]], where: str
    ) -> Callable[[], list[Solid]]:
        return lambda: [
            Solid(self.settings.scale * solid.mass, solid.center, self.settings.scale * solid.inertia)
            for solid in masses_of(contents, self.settings, where)
        ]

    def _axes(self, element: Element, frame: Pose, inherited: str | None, where: str) -> list[Axis]:
        if element.tag != "joint":
            return []
        given = self.settings.attributes(element, inherited, where)
        kind = given.get("type", "hinge")
        if kind not in ("hinge", "slide"):
            return []
        return [_axis(given, frame, self.settings, kind == "slide", where)]


def _axis(given: dict[str, str], frame: Pose, settings: Settings, slides: bool, where: str) -> Axis:
    place = f"{where}: joint {given.get('name', 'without a name')!r}"
    position = (lambda value: value) if slides else settings.angle
    return Axis(
        name=given.get("name", ""),
        slides=slides,
        direction=frame.rotation @ direction(given, "axis", "0 0 1", place),
        anchor=frame.of(vector(given, "pos", "0 0 0", place)),
        reference=position(number(given, "ref", 0.0, place)),
        armature=number(given, "armature", 0.0, place),
        stiffness=number(given, "stiffness", 0.0, place),
        relaxed=position(number(given, "springref", 0.0, place)),
        damping=number(given, "damping", 0.0, place),
        friction=number(given, "frictionloss", 0.0, place),
        effort_limit=_limit(given, settings, place),
    )


def _limit(given: dict[str, str], settings: Settings, where: str) -> float | None:
    limited = given.get("actuatorfrclimited", "auto")
    if (
        "actuatorfrcrange" not in given
        or limited == "false"
        or (limited == "auto" and not settings.autolimits)
    ):
        return None
    return float(np.abs(numbers(given, "actuatorfrcrange", "", where, least=2)[:2]).max()) or None
