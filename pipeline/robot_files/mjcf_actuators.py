"""Actuators of MJCF that drive one joint: a position controller, its limit and its gear (XML reference, actuator)."""

from collections.abc import Mapping
from xml.etree.ElementTree import Element

import numpy as np

from simgap.robot_files.bodies import Axis, Controller
from simgap.robot_files.mjcf_settings import Settings
from simgap.robot_files.values import number, numbers


def add_actuators(root: Element, settings: Settings, axes: Mapping[str, Axis]) -> None:
    """Add to each joint what its actuators say.

    Args:
        root: of the document.
        settings: of the file.
        axes: the joints by name.
    """
    for element in (entry for section in root.findall("actuator") for entry in section):
        where = f"{settings.file}: {element.tag} {element.get('name', 'without a name')!r}"
        given = settings.attributes(element, None, where)
        name = given.get("joint", given.get("jointinparent"))
        axis = axes.get(name) if name else None
        if axis is not None:
            _add(axis, element.tag, given, settings, where)


def _add(axis: Axis, tag: str, given: dict[str, str], settings: Settings, where: str) -> None:
    gear = number(given, "gear", 1.0, where)
    limit = _limit(given, gear, settings, where)
    limits = [each for each in (axis.effort_limit, limit) if each is not None]
    axis.effort_limit = min(limits, default=None)
    gains = _gains(tag, given, where)
    if gains is not None and axis.controller is None:
        # The actuator's length is gear · position, and its effort acts gear times at the joint.
        axis.controller = Controller(gains[0] * gear**2, gains[1] * gear**2)
        ratio = number(given, "dampratio", 0.0, where)
        axis.damping_ratio = ratio if tag == "position" and ratio > 0.0 else None
    elif gear != 1.0:
        axis.remarks.append(
            f"The gear of {gear:g} of its actuator is used where the platform names a motor: "
            f"platform.motor.name=NAME platform.motor.gear_ratio={gear:g}."
        )
    if given.get("dyntype", "none") != "none" or number(given, "timeconst", 0.0, where) > 0.0:
        axis.remarks.append("The lag of its actuator is not used.")


def _gains(tag: str, given: dict[str, str], where: str) -> tuple[float, float] | None:
    """Return proportional and derivative gain of a position controller; None for any other actuator."""
    if tag == "position":
        return number(given, "kp", 1.0, where), number(given, "kv", 0.0, where)
    if tag != "general" or given.get("biastype") != "affine" or given.get("gaintype", "fixed") != "fixed":
        return None
    gain = number(given, "gainprm", 1.0, where)
    bias = numbers(given, "biasprm", "0", where)
    _, position, velocity = np.append(bias, np.zeros(3))[:3]
    return (gain, -float(velocity)) if gain > 0.0 and position == -gain else None


def _limit(given: dict[str, str], gear: float, settings: Settings, where: str) -> float | None:
    limited = given.get("forcelimited", "auto")
    if "forcerange" not in given or limited == "false" or (limited == "auto" and not settings.autolimits):
        return None
    largest = float(np.abs(numbers(given, "forcerange", "", where, least=2)[:2]).max())
    return largest * abs(gear) or None
