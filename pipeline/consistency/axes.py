"""A driven axis against its drive: a joint, and the wheels and modules of a swerve drive."""

from collections.abc import Iterator

import numpy as np

from simgap.consistency.law import Ratio, Term, law_agreement
from simgap.consistency.redundancy import Agreement
from simgap.consistency.samples import Samples
from simgap.platforms.joint import Joint, JointMotor
from simgap.platforms.swerve import Swerve, SwerveAxis

INERTIA = Ratio(0.7)
"""A rotor's inertia behind the gear is rarely published (`effects/joint`, prior of `inertia_error`)."""

LOAD = Ratio(0.7, more=0.3)
"""Other loads and springs add to what the platform tells of."""

MASS = Ratio(0.5)
BACK_EMF = Ratio(0.3, more=0.2)
"""A motor constant is known to a third; in one axis of five viscous friction is like the back-EMF, and adds to it."""

ELECTRIC = Ratio(0.3)
_CREEP = 0.05  # of the usual speed: within it friction changes its sign
_PER_MODULE = 0.75  # four modules are alike: their errors are, too


def joint_laws(samples: Samples, joint: Joint) -> Iterator[Agreement | None]:
    """Yield the comparison of a joint's effort or voltage with its motion, and of its current with its voltage."""
    if "effort" in samples:
        yield _effort_law(samples, joint)
    motor = joint.motor
    if motor is None or "voltage" not in samples:
        return
    columns = ("voltage", "position", "velocity")
    volts, terms, others = voltage_law(samples, joint, motor)
    yield law_agreement("'voltage' against the motion", columns, volts, terms, others, fits=False)
    if "current" in samples:
        yield _circuit(samples, motor, volts, samples.mean(samples["velocity"]))


def _effort_law(samples: Samples, joint: Joint) -> Agreement | None:
    position, velocity = samples.mean(samples["position"]), samples.mean(samples["velocity"])
    inertial = joint.inertia * samples.rate(samples["velocity"])
    jerky = joint.inertia * samples.noise_of_rate(samples["velocity"])
    terms = [Term(inertial, INERTIA, jerky), *_told_load(joint, position, 1.0)]
    others = _with(_other_physics(joint, position, velocity), velocity)
    columns = ("effort", "position", "velocity")
    drive = samples.mean(samples["effort"])
    return law_agreement("'effort' against the motion", columns, drive, terms, others, fits=False)


def voltage_law(
    samples: Samples, joint: Joint, motor: JointMotor
) -> tuple[np.ndarray, list[Term], np.ndarray]:
    """Return the voltage of a joint's motor, what the platform foretells of it (inertia and back-EMF first), and other
    physics that may add to it; (windows,) each, V.
    """
    position, velocity = samples.mean(samples["position"]), samples.mean(samples["velocity"])
    constant = motor.torque_constant * motor.gear_ratio
    inertia = motor.resistance / constant * joint.inertia
    jerky, shaky = samples.noise_of_rate(samples["velocity"]), samples.noise_of_mean(samples["velocity"])
    terms = [
        Term(inertia * samples.rate(samples["velocity"]), INERTIA, inertia * jerky),
        Term(constant * velocity, BACK_EMF, constant * shaky, exact=True),
        *_told_load(joint, position, motor.resistance / constant),
    ]
    return samples.mean(samples["voltage"]), terms, _other_physics(joint, position, velocity)


def _circuit(
    samples: Samples, motor: JointMotor, volts: np.ndarray, velocity: np.ndarray
) -> Agreement | None:
    terms = [
        Term(motor.resistance * samples.mean(samples["current"]), ELECTRIC),
        Term(motor.torque_constant * motor.gear_ratio * velocity, ELECTRIC),
    ]
    columns = ("current", "voltage", "velocity")
    return law_agreement(
        "'voltage' against 'current' and the speed", columns, volts, terms, _constant(velocity)
    )


def swerve_laws(samples: Samples, swerve: Swerve, group: str) -> Iterator[Agreement | None]:
    """Yield the comparison of the voltage of each motor of a group with its motion."""
    carried = 0.25 * swerve.mass * swerve.wheel_radius**2 / swerve.drive.gear_ratio
    axis, inertia, ratio = (
        (swerve.drive, carried, MASS) if group == "drive" else (swerve.steer, swerve.steer.inertia, INERTIA)
    )
    for module in "1234":
        yield _motor(samples, group, module, axis, inertia, ratio)


def _motor(
    samples: Samples, group: str, module: str, axis: SwerveAxis, inertia: float, ratio: Ratio
) -> Agreement | None:
    """Compare a motor's voltage with its motion; `inertia` is that at the recorded speed over the gear."""
    motor, columns = axis.motor, (f"{group}_voltage_{module}", f"{group}_velocity_{module}")
    velocity = samples.mean(samples[columns[1]])
    turns = velocity if group == "drive" else axis.gear_ratio * velocity
    volts = motor.resistance / motor.torque_constant * inertia / axis.gear_ratio
    recorded = samples[columns[1]]
    shaky = samples.noise_of_mean(recorded) * (1.0 if group == "drive" else axis.gear_ratio)
    terms = [
        Term(volts * samples.rate(recorded), ratio, volts * samples.noise_of_rate(recorded)),
        Term(motor.back_emf_constant * turns, BACK_EMF, motor.back_emf_constant * shaky, exact=True),
    ]
    name = f"{columns[0]!r} against the motion"
    others = np.concatenate([_constant(velocity), _friction(velocity)], axis=-1)
    return law_agreement(name, columns, samples.mean(samples[columns[0]]), terms, others, _PER_MODULE)


def _told_load(joint: Joint, position: np.ndarray, scale: float) -> list[Term]:
    """Return the gravity torque and the spring that the platform tells of."""
    told = [(joint.gravity_torque, np.sin(position)), (joint.stiffness, position)]
    return [Term(scale * size * shape, LOAD) for size, shape in told if size != 0.0]


def _other_physics(joint: Joint, position: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Return dry friction, a constant load, and gravity and a spring that the platform does not tell of."""
    shapes = [np.cos(position)]
    shapes += [np.sin(position)] if joint.gravity_torque == 0.0 else []
    shapes += [position] if joint.stiffness == 0.0 else [position**3]
    return np.concatenate([_constant(velocity), _friction(velocity), np.stack(shapes, axis=-1)], axis=-1)


def _friction(velocity: np.ndarray) -> np.ndarray:
    known = velocity[np.isfinite(velocity)]
    usual = float(np.sqrt(np.mean(known**2))) if known.any() else 1.0
    return np.tanh(velocity / (_CREEP * usual))[:, None]


def _constant(velocity: np.ndarray) -> np.ndarray:
    return np.ones((len(velocity), 1))


def _with(others: np.ndarray, column: np.ndarray) -> np.ndarray:
    return np.concatenate([others, column[:, None]], axis=-1)
