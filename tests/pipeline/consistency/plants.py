"""Good recordings of all kinds: of the project's plants, as the benchmark draws them, and of a servo by its law."""

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from simgap.artifacts.plain_yaml import read_yaml
from simgap.plants.concealed import ConcealedCase, draw_cases, record_concealed
from simgap.platforms import Joint
from simgap.platforms.joint import JointMotor
from simgap.recordings.recording import Recording, recording_from_frame

ROOT = Path(__file__).parents[3]
SHORT = {"runs": 2, "duration": 4.0}
SERVO = Joint(inertia=0.02, motor=JointMotor(resistance=0.5, torque_constant=0.02, gear_ratio=20.0))
STEP = 0.01


class Good(NamedTuple):
    """A good recording with its platform file, what it is called, and which effects are in it."""

    recording: Recording
    platform: dict[str, Any]
    name: str
    effects: frozenset[str]


def _read(path: str) -> Any:
    return read_yaml(ROOT / path)


def cases(kind: str, seed: int, count: int) -> list[ConcealedCase]:
    table = _read(f"conf/prove/{kind}.yaml")[kind]
    machines = {name: {"kind": kind} | _read(f"conf/platform/{name}.yaml") for name in table["machines"]}
    return draw_cases(kind, table, _read("conf/prove/default.yaml")["shares"], machines, seed, count)


def good(
    kind: str, seed: int, count: int, factors: tuple[float, ...] = (1.0,), short: bool = False
) -> Iterator[Good]:
    """Yield recordings of concealed cases; none of them contradicts itself.

    Args:
        kind: of platform.
        seed: of the cases.
        count: of the cases.
        factors: how many times as strong as usual the effects are.
        short: whether two runs of 4 s suffice.
    """
    for case in cases(kind, seed, count):
        for factor in factors:
            if factor != 1.0 and not case.effects:
                continue
            for effect in case.effects:
                case = case.scaled(effect, factor)
            if short:
                case.record.update(SHORT)
            yield Good(
                record_concealed(case)[0],
                case.platform,
                f"{kind} {case.number} {case.subject.names} x{factor:g}",
                frozenset(case.subject.names) | frozenset(case.record.get("effects", {})),
            )


@cache
def sample(kind: str) -> tuple[Good, ...]:
    """Return a handful of short recordings of a kind, made once in a session."""
    count = {"joint": 4, "swerve": 1, "quadrotor": 1}[kind]
    return tuple(good(kind, 777, count, short=True))


def servo(friction: float = 0.4, scale: float = 1.0, viscous: float = 0.0, joint: Joint = SERVO) -> Recording:
    """Return a servo that is moved along sums of sines by exactly the voltage that it needs, over `scale`."""
    motor = joint.motor
    assert motor is not None
    random = np.random.default_rng(5)
    runs = []
    for run in range(3):
        time = np.arange(0.0, 6.0, STEP)
        rates, phases = random.uniform(1.0, 6.0, 5), random.uniform(0.0, 6.0, 5)
        waves = rates * time[:, None] + phases
        position = 0.4 * np.sin(waves).sum(axis=1)
        velocity = 0.4 * (rates * np.cos(waves)).sum(axis=1)
        torque = -0.4 * joint.inertia * (rates**2 * np.sin(waves)).sum(axis=1)
        torque += friction * np.tanh(velocity / 0.05) + viscous * velocity
        constant = motor.torque_constant * motor.gear_ratio
        voltage = motor.resistance * torque / constant + constant * velocity
        columns = {"run": f"run{run}", "t": time, "position": position + random.normal(0, 1e-4, len(time))}
        columns |= {"velocity": velocity + random.normal(0, 5e-3, len(time)), "voltage": voltage / scale}
        runs.append(pd.DataFrame(columns))
    return recording_from_frame(pd.concat(runs, ignore_index=True), "joint")
