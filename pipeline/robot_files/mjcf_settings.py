"""What the sections `compiler`, `default` and `option` of an MJCF file say (mujoco.readthedocs.io, XML reference)."""

import math
from dataclasses import dataclass, field
from xml.etree.ElementTree import Element

import numpy as np

from simgap.errors import InputError
from simgap.robot_files.bodies import Pose
from simgap.robot_files.values import number, numbers, unit, vector

_MAIN = "main"
_UNREAD = ("boundmass", "boundinertia")  # they change single masses
_ACTUATORS = (
    "general",
    "motor",
    "position",
    "velocity",
    "intvelocity",
    "damper",
    "cylinder",
    "muscle",
    "adhesion",
)


@dataclass
class Settings:
    """How the elements of the file are to be read.

    Attributes:
        file: for a message.
        degrees: whether angles are in degrees.
        sequence: of Euler angles, in MJCF's letters.
        from_shapes: whether masses come from shapes: `true`, `false`, or `auto`, where no inertial says them.
        groups: of shapes that have a mass, first and last.
        autolimits: whether a range alone makes a limit.
        total_mass: of all bodies, to which their masses are scaled, kg; 0 where they hold as they are.
        scale: of every mass.
        gravity: m/s², shape (3,).
        defaults: class to tag to attributes.
    """

    file: str
    degrees: bool = True
    sequence: str = "xyz"
    from_shapes: str = "auto"
    groups: tuple[float, float] = (0.0, 5.0)
    autolimits: bool = True
    total_mass: float = 0.0
    scale: float = 1.0
    gravity: np.ndarray = field(default_factory=lambda: np.array([0.0, 0.0, -9.81]))
    defaults: dict[str, dict[str, dict[str, str]]] = field(default_factory=lambda: {_MAIN: {}})

    def angle(self, value: float) -> float:
        """Return an angle of the file, rad."""
        return math.radians(value) if self.degrees else value

    def attributes(self, element: Element, inherited: str | None, where: str) -> dict[str, str]:
        """Return the attributes of an element with the defaults of its class.

        Args:
            element: of the file.
            inherited: the class that a body around it sets.
            where: the place to name in an error.

        Raises:
            InputError: when there is no such class.
        """
        name = element.get("class") or inherited or _MAIN
        if name not in self.defaults:
            raise InputError(f"there is no default class {name!r}", where, "correct the file")
        return {**_defaults_of(self.defaults[name], element.tag), **element.attrib}

    def pose(self, attributes: dict[str, str], where: str) -> Pose:
        """Return position and orientation that the attributes of an element give."""
        return Pose(vector(attributes, "pos", "0 0 0", where), self._rotation(attributes, where))

    def _rotation(self, attributes: dict[str, str], where: str) -> np.ndarray:
        from scipy.spatial.transform import Rotation

        if "quat" in attributes:
            quaternion = unit(numbers(attributes, "quat", "", where, least=4)[:4], "the quaternion", where)
            return Rotation.from_quat(np.roll(quaternion, -1)).as_matrix()
        if "axisangle" in attributes:
            *axis, angle = numbers(attributes, "axisangle", "", where, least=4)[:4]
            turned = unit(np.array(axis), "axisangle", where) * self.angle(float(angle))
            return Rotation.from_rotvec(turned).as_matrix()
        if "euler" in attributes:
            angles = vector(attributes, "euler", "", where)
            # Small letters turn with the body here, and capital letters do so in SciPy.
            return Rotation.from_euler(self.sequence.swapcase(), angles, degrees=self.degrees).as_matrix()
        if "xyaxes" in attributes:
            return _from_axes(numbers(attributes, "xyaxes", "", where, least=6)[:6], where)
        if "zaxis" in attributes:
            return along(vector(attributes, "zaxis", "", where), where)
        return np.eye(3)


def along(axis: np.ndarray, where: str) -> np.ndarray:
    """Return the smallest rotation that takes z to an axis, shape (3, 3)."""
    from scipy.spatial.transform import Rotation

    target = unit(axis, "the axis", where)
    across = np.cross([0.0, 0.0, 1.0], target)
    length = float(np.linalg.norm(across))
    if length < 1e-12:  # along z or against it
        return np.diag([1.0, math.copysign(1.0, target[2]), math.copysign(1.0, target[2])])
    return Rotation.from_rotvec(across / length * math.atan2(length, target[2])).as_matrix()


def _from_axes(values: np.ndarray, where: str) -> np.ndarray:
    x = unit(values[:3], "xyaxes", where)
    y = unit(values[3:] - x * (x @ values[3:]), "xyaxes", where)
    return np.column_stack([x, y, np.cross(x, y)])


def read_settings(root: Element, file: str) -> Settings:
    """Return the settings of an MJCF document.

    Raises:
        InputError: on a setting that changes masses and is not read here.
    """
    settings = Settings(file)
    for compiler in root.findall("compiler"):
        _compile(settings, compiler, f"{file}: compiler")
    for option in root.findall("option"):
        if "gravity" in option.attrib:
            settings.gravity = vector(option.attrib, "gravity", "", f"{file}: option")
    for default in root.findall("default"):
        _collect(settings.defaults, default, {}, True)
    return settings


def _compile(settings: Settings, compiler: Element, where: str) -> None:
    given = compiler.attrib
    for key in _UNREAD:
        if number(given, key, 0.0, where) > 0.0:
            raise InputError(f"{key} is not read", where, "give the masses themselves")
    settings.total_mass = number(given, "settotalmass", settings.total_mass, where)
    settings.degrees = given.get("angle", "degree" if settings.degrees else "radian") == "degree"
    settings.sequence = given.get("eulerseq", settings.sequence)
    if len(settings.sequence) != 3 or settings.sequence not in _sequences():
        raise InputError(f"eulerseq={settings.sequence!r} is no sequence", where, "correct the file")
    settings.from_shapes = given.get("inertiafromgeom", settings.from_shapes)
    first, last = numbers(given, "inertiagrouprange", "{} {}".format(*settings.groups), where, least=2)[:2]
    settings.groups = (float(first), float(last))
    settings.autolimits = given.get("autolimits", "true" if settings.autolimits else "false") == "true"


def _sequences() -> set[str]:
    from itertools import product

    words = {"".join(letters) for letters in product("xyz", repeat=3)}
    proper = {word for word in words if word[0] != word[1] != word[2]}
    return proper | {word.upper() for word in proper}


def _collect(
    defaults: dict[str, dict[str, dict[str, str]]],
    default: Element,
    outer: dict[str, dict[str, str]],
    top: bool,
) -> None:
    """Add a class and those in it: each has what the class around it has, and its own."""
    name = _MAIN if top else default.get("class", "")
    known = defaults[_MAIN] if top else outer
    own = {tag: dict(attributes) for tag, attributes in known.items()}
    for element in default:
        if element.tag != "default":
            own[element.tag] = {**own.get(element.tag, {}), **element.attrib}
    defaults[name] = own
    if top and default.get("class"):
        defaults[default.get("class", "")] = own
    for element in default.findall("default"):
        _collect(defaults, element, own, False)


def _defaults_of(known: dict[str, dict[str, str]], tag: str) -> dict[str, str]:
    """Return the defaults of a tag; all sorts of actuators share those of `general`."""
    shared = known.get("general", {}) if tag in _ACTUATORS else {}
    return {**shared, **known.get(tag, {})}
