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

SPEED = Ratio(0.3)
"""A battery and a propeller that is not the nominal one change the speed that a command makes."""

TORQUE = Ratio(0.7)
TURNED = "rotor_directions"
"""Of the platform, as a column: −1 where they are suspected of being the other way round."""

_STATE = {"attitude": "wxyz", "velocity": "xyz", "body_rate": "xyz"}
_FELT = {"specific_force": "xyz"}
_ALIKE = 0.5  # speeds and commands of the motors say much the same


def rotor_laws(samples: Samples, quadrotor: Quadrotor, stem: str) -> Iterator[Agreement | None]:
    """Yield the comparison of thrust and torques with the motion.

    Args:
        samples: of the recording.
        quadrotor: the platform.
        stem: `motor_speed` or `motor_command`.
    """
    parts = {name: parts for name, parts in (_STATE | _FELT).items() if samples.has(name, parts)}
    columns = [f"{name}_{part}" for name in parts for part in parts[name]]
    felt, wanted, others = samples.once("motion", columns, lambda same: _motion(same, quadrotor))
    thrusts, reactions = _rotors(samples, quadrotor, stem)
    group = f"{stem}_1..4"
    thrust = thrusts.sum(axis=-1)
    if felt is not None:
        measured = ("attitude", "velocity") if "attitude" in parts else ("specific_force_z",)
        name = f"the thrust of {group!r} against the acceleration"
        # The motion is regressed on what is foretold, without any other term: a thrust carries the weight all the time.
        none = np.ones((len(felt), 0))
        yield law_agreement(
            name, (group, *measured), felt[:, 2], [Term(thrust / quadrotor.mass, THRUST)], none
        )
    positions = np.array(quadrotor.rotor_positions)
    # Rotors that are not alike, and a centre of mass beside the middle, bring a torque in proportion to the thrust.
    others = np.concatenate([others, thrust[:, None]], axis=-1)
    torques = (thrusts @ positions[:, 1], -thrusts @ positions[:, 0], reactions.sum(axis=-1))
    for axis, made, needed in zip("xyz", torques, wanted.T, strict=True):
        name = f"the torque about {axis} of {group!r} against the turning"
        yield law_agreement(name, (group, f"body_rate_{axis}"), needed, [Term(made, TORQUE)], others, _ALIKE)


def speed_laws(samples: Samples, quadrotor: Quadrotor) -> Iterator[Agreement | None]:
    """Yield the comparison of each rotor's speed with its command."""
    if not (samples.has("motor_speed", "1234") and samples.has("motor_command", "1234")):
        return
    for rotor in "1234":
        speed = samples.mean(samples[f"motor_speed_{rotor}"])
        told = quadrotor.motor_speed_max * samples.mean(samples[f"motor_command_{rotor}"])
        columns = (f"motor_speed_{rotor}", f"motor_command_{rotor}")
        name = f"{columns[0]!r} against {columns[1]!r}"
        yield law_agreement(name, columns, speed, [Term(told, SPEED)], np.ones((len(speed), 0)), _ALIKE)


def _rotors(samples: Samples, quadrotor: Quadrotor, stem: str) -> tuple[np.ndarray, np.ndarray]:
    """Return thrust, N, and reaction torque about z, N·m, of each rotor, (windows, 4)."""
    speed = quadrotor.motor_speed_max if stem == "motor_command" else 1.0
    squared = samples.mean((speed * samples.stack(stem, "1234")) ** 2)
    alike = (1.0, 1.0, 1.0, 1.0)
    thrusts = quadrotor.thrust_coefficient * np.array(quadrotor.thrust_ratios or alike) * squared
    turned = np.array(quadrotor.rotor_directions) * np.array(quadrotor.torque_ratios or alike)
    turned = samples[TURNED][0] * turned if TURNED in samples else turned
    return thrusts, quadrotor.torque_coefficient * turned * squared


def _motion(samples: Samples, quadrotor: Quadrotor) -> tuple[np.ndarray | None, np.ndarray, np.ndarray]:
    """Return the specific force, (windows, 3), the torques that the turning needs, and what else may bring torques.

    Where no attitude and velocity were recorded, the accelerometer tells the force, if there is one.
    """
    rates = samples.mean(samples.stack("body_rate", "xyz"))
    others = [np.ones((len(rates), 1)), rates]
    felt = None
    if samples.has("attitude", "wxyz"):
        felt = in_body(samples, acceleration(samples))
        others.append(in_body(samples, samples.mean(samples.stack("velocity", "xyz"))))
    elif samples.has("specific_force", "xyz"):
        felt = samples.mean(samples.stack("specific_force", "xyz"))
    return felt, _needed_torques(samples, quadrotor), np.concatenate(others, axis=-1)


def _needed_torques(samples: Samples, quadrotor: Quadrotor) -> np.ndarray:
    """Return J·dω/dt + ω × J·ω, (windows, 3) N·m."""
    rates = samples.stack("body_rate", "xyz")
    moments = np.array(quadrotor.inertia)
    mean = samples.mean(rates)
    return moments * samples.rate(rates) + np.cross(mean, moments * mean)
