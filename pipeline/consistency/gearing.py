"""A gear ratio, or a motor, that would explain a joint's voltage better than the one in the platform file.

A motor needs V = k·N·v + R·J/(k·N)·a beside what friction and loads take: N is the gear ratio, k the torque constant, R
the resistance and J the inertia of the joint. The voltage is regressed on both terms as the platform foretells them. A
gear ratio that is r times as large makes the first one r times as large and the second one r times as small. No other
number of the platform does that but the torque constant, of which data sheets promise a tenth.
"""

import math
from dataclasses import dataclass

from simgap.consistency.axes import voltage_law
from simgap.consistency.law import Estimate, estimates_of
from simgap.consistency.samples import samples_of
from simgap.platforms.joint import Joint, JointMotor
from simgap.platforms.motors import NamedMotor, motors
from simgap.recordings.cleaning.clean import mended
from simgap.recordings.recording import Recording

UNUSUAL = math.log(1.25)  # no data sheet's torque constant is off by a quarter
_KNOWN = 0.05  # of a platform number: a maker's tolerance, which counts beside the errors of the regression
_LEAST_EXPLAINED = 0.5  # of what the other terms leave; with less, something else is at work
_MOST_LEFT = 0.1  # of the voltage's energy
_WITHIN = 2.0  # standard deviations
_MOST_MOTORS = 4  # on one shaft


def gear_doubts(recording: Recording, joint: Joint) -> list[str]:
    """Return a sentence if another gear ratio or another motor explains both numbers of a joint's motor, else none.

    Args:
        recording: of the joint, raw or cleaned.
        joint: the platform.
    """
    motor = joint.motor
    if motor is None or not {"voltage", "velocity"} <= set(recording.channels):
        return []
    samples = samples_of(recording if recording.cleaned else mended(recording))
    found = estimates_of(*voltage_law(samples, joint, motor))
    if found is None or found[1] > _MOST_LEFT:
        return []
    inertia, back_emf = found[0][:2]
    if not all(_tells(each) for each in (inertia, back_emf)):
        return []
    return _said(motor, inertia, back_emf)


def _tells(estimate: Estimate) -> bool:
    return estimate.value > 0.0 and estimate.explained > _LEAST_EXPLAINED


def _said(motor: JointMotor, inertia: Estimate, back_emf: Estimate) -> list[str]:
    causes = _causes(motor, inertia, back_emf)
    if abs(math.log(back_emf.value)) < UNUSUAL or not causes:
        return []
    return [
        f"the recorded voltage needs {back_emf.value:.3g} times the back-EMF and {inertia.value:.3g} times the inertia "
        f"that the platform file foretells; {' or '.join(causes)} explains both: check the platform file before you "
        "believe a wrong number or friction"
    ]


def _causes(motor: JointMotor, inertia: Estimate, back_emf: Estimate) -> list[str]:
    """Return which single wrong entry of the platform file explains both numbers."""
    causes = []
    if _within(back_emf.value * inertia.value, back_emf, inertia):
        gear = back_emf.value * motor.gear_ratio  # of both numbers, the inertia is known less well
        causes.append(f"a gear_ratio of {gear:.3g} instead of {motor.gear_ratio:.4g}")
    named = _name_of(motor)
    if named is not None:
        others = [other.name for other in motors() if _explains(other, named, inertia, back_emf)]
        causes += [f"the motor {other} instead of {named.motor.name}" for other in others]
    return causes


def _within(ratio: float, *estimates: Estimate) -> bool:
    """Whether a ratio is one, within the errors of what it was made of and the tolerance of platform numbers."""
    errors = [estimate.error / estimate.value for estimate in estimates]
    return abs(math.log(ratio)) < _WITHIN * math.hypot(*errors, _KNOWN)


@dataclass(frozen=True)
class _Chosen:
    """A motor of the table, how many of them, and the gear behind them."""

    motor: NamedMotor
    count: int
    gear_ratio: float

    def of_joint(self, motor: NamedMotor) -> JointMotor:
        return JointMotor(**motor.of_joint(self.count, self.gear_ratio))


def _name_of(motor: JointMotor) -> _Chosen | None:
    """Return which motor of the table a platform has, if it has one."""
    for known in motors():
        for count in range(1, _MOST_MOTORS + 1):
            chosen = _Chosen(known, count, motor.gear_ratio / known.gear_ratio)
            made = chosen.of_joint(known)
            if math.isclose(made.resistance, motor.resistance) and math.isclose(
                made.torque_constant, motor.torque_constant
            ):
                return chosen
    return None


def _explains(other: NamedMotor, named: _Chosen, inertia: Estimate, back_emf: Estimate) -> bool:
    """Whether both numbers are those of another motor behind the same gear."""
    told, made = named.of_joint(named.motor), named.of_joint(other)
    constant = made.torque_constant * made.gear_ratio / (told.torque_constant * told.gear_ratio)
    needed = made.resistance / told.resistance / constant
    return _within(back_emf.value / constant, back_emf) and _within(inertia.value / needed, inertia)
