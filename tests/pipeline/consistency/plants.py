"""Good recordings of all kinds from the project's plants, as the benchmark draws them."""

from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

from simgap.artifacts.plain_yaml import read_yaml
from simgap.plants.concealed import ConcealedCase, draw_cases, record_concealed
from simgap.recordings.recording import Recording

ROOT = Path(__file__).parents[3]
SHORT = {"runs": 2, "duration": 4.0}


class Good(NamedTuple):
    """A good recording with its platform file and what it is called."""

    recording: Recording
    platform: dict[str, Any]
    name: str


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
            )


@cache
def sample(kind: str) -> tuple[Good, ...]:
    """Return a handful of short recordings of a kind, made once in a session."""
    count = {"joint": 4, "swerve": 1, "quadrotor": 1}[kind]
    return tuple(good(kind, 777, count, short=True))
