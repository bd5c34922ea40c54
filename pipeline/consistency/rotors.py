"""The rotors of a quadrotor against its motion: thrust against the acceleration, torques against the turning."""

from collections.abc import Iterator

import numpy as np

from simgap.consistency.attitude import acceleration, in_body
from simgap.consistency.law import Ratio, Term, law_agreement
from simgap.consistency.redundancy import Agreement
from simgap.consistency.samples import Samples
from simgap.platforms.quadrotor import Quadrotor

THRUST = Ratio(0.4)
"""Mass and thrust coefficient are known to a third; the battery takes as much."""

TORQUE = Ratio(0.7)
_ALIKE = 0.5  # speeds and commands of the motors say much the same


def rotor_laws(samples: Samples, quadrotor: Quadrotor, stem: str) -> Iterator[Agreement | None]:
    """Yield the comparison of thrust and torques with the motion.

    Args:
        samples: of the recording.
        quadrotor: the platform.
        stem: `motor_speed` or `motor_command`.
    """
    felt = in_body(samples, acceleration(samples))
    velocity = in_body(samples, samples.mean(samples.stack("velocity", "xyz")))
    rates = samples.mean(samples.stack("body_rate", "xyz"))
    others = np.concatenate([np.ones((len(felt), 1)), rates, velocity], axis=-1)
    thrusts, reactions = _rotors(samples, quadrotor, stem)
    group = f"{stem}_1..4"
    lift = thrusts.sum(axis=-1) / quadrotor.mass
    name = f"the thrust of {group!r} against the acceleration"
    # The motion is regressed on what is foretold, without any other term: a thrust carries the weight all the time.
    none = np.ones((len(felt), 0))
    yield law_agreement(name, (group, "attitude", "velocity"), felt[:, 2], [Term(lift, THRUST)], none)
    positions = np.array(quadrotor.rotor_positions)
    torques = (thrusts @ positions[:, 1], -thrusts @ positions[:, 0], reactions.sum(axis=-1))
    for axis, made, needed in zip("xyz", torques, _needed_torques(samples, quadrotor).T, strict=True):
        name = f"the torque about {axis} of {group!r} against the turning"
        yield law_agreement(name, (group, f"body_rate_{axis}"), needed, [Term(made, TORQUE)], others, _ALIKE)


def _rotors(samples: Samples, quadrotor: Quadrotor, stem: str) -> tuple[np.ndarray, np.ndarray]:
    """Return thrust, N, and reaction torque about z, N·m, of each rotor, (windows, 4)."""
    speed = quadrotor.motor_speed_max if stem == "motor_command" else 1.0
    squared = samples.mean((speed * samples.stack(stem, "1234")) ** 2)
    alike = (1.0, 1.0, 1.0, 1.0)
    thrusts = quadrotor.thrust_coefficient * np.array(quadrotor.thrust_ratios or alike) * squared
    turned = np.array(quadrotor.rotor_directions) * np.array(quadrotor.torque_ratios or alike)
    return thrusts, quadrotor.torque_coefficient * turned * squared


def _needed_torques(samples: Samples, quadrotor: Quadrotor) -> np.ndarray:
    """Return J·dω/dt + ω × J·ω, (windows, 3) N·m."""
    rates = samples.stack("body_rate", "xyz")
    moments = np.array(quadrotor.inertia)
    mean = samples.mean(rates)
    return moments * samples.rate(rates) + np.cross(mean, moments * mean)
