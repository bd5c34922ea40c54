"""What is measured: peers, linearity, the floors, and what each part costs."""

from dataclasses import dataclass
from functools import partial
from typing import Any

from benchmarks.contender import Contender
from benchmarks.floors import copy_seconds, operations_per_second
from benchmarks.laps import Laps, in_turns
from benchmarks.ours import RACING, fused
from simgap.effects import ActuatorEffect, WrenchEffect, effects_of

OURS = "simgap"
BATCHES = {"cpu": (1, 100, 10_000, 100_000), "cuda": (1, 100, 10_000, 100_000, 1_000_000)}
LINEAR = (1_000, 3_000, 10_000, 30_000, 100_000)
_PEERS = {
    "crazyflow, rates": ("crazyflow", {"control": "body_rate"}),
    "crazyflow, attitude": ("crazyflow", {"control": "attitude"}),
    "rotorpy": ("rotorpy", {"inner": 5}),
    "rotorpy, one step of 10 ms": ("rotorpy", {"inner": 1}),
}


@dataclass(frozen=True)
class Plan:
    """How long to measure, and where.

    Attributes:
        peers: the Python of the environment that has the peers.
        device: cpu or cuda.
        rounds: of turns.
        seconds: of a lap.
    """

    peers: str
    device: str
    rounds: int
    seconds: float


def ours(plan: Plan, process: Contender, **request: Any) -> Any:
    """Return what runs one lap of the racer."""
    chosen = {"path": "whole", "integrator": "rk4", "effects": list(RACING), "device": plan.device} | request
    return partial(process.rate, plan.seconds, **chosen)


def against_peers(plan: Plan) -> dict[tuple[int, str], dict[str, Laps]]:
    """Return the laps of ours and the peers, by batch and integrator of the inner step."""
    simgap = Contender(".venv/bin/python", "benchmarks.ours")
    found: dict[tuple[int, str], dict[str, Laps]] = {}
    for batch in BATCHES[plan.device]:
        for integrator in ("rk4", "euler"):
            processes = {
                name: Contender(plan.peers, f"benchmarks.peer_{name}") for name in ("crazyflow", "rotorpy")
            }
            contenders = {
                OURS: ours(plan, simgap, batch=batch, integrator=integrator),
                f"{OURS}, one inner step per call": ours(
                    plan, simgap, batch=batch, integrator=integrator, path="inner"
                ),
                f"{OURS}, eager": ours(plan, simgap, batch=batch, integrator=integrator, path="eager"),
                f"{OURS}, one step of 10 ms": ours(
                    plan, simgap, batch=batch, integrator=integrator, substeps=1
                ),
            }
            for name, (peer, options) in _PEERS.items():
                if _has(plan, peer, integrator):
                    request = {**options, "batch": batch} | (
                        {"integrator": integrator} if peer == "crazyflow" else {"device": plan.device}
                    )
                    contenders[name] = partial(processes[peer].rate, plan.seconds, **request)
            found[batch, integrator] = in_turns(contenders, plan.rounds)
            for process in processes.values():
                process.close()
    simgap.close()
    return found


def _has(plan: Plan, peer: str, integrator: str) -> bool:
    """Return whether a peer knows the integrator, on the device that is measured."""
    return integrator == "rk4" if peer == "rotorpy" else plan.device == "cpu"


def linearity(plan: Plan) -> dict[int, Laps]:
    """Return the laps of the racer by batch."""
    process = Contender(".venv/bin/python", "benchmarks.ours")
    laps = in_turns({str(batch): ours(plan, process, batch=batch) for batch in LINEAR}, plan.rounds)
    process.close()
    return {int(batch): series for batch, series in laps.items()}


@dataclass(frozen=True)
class Floor:
    """What a control step of one machine needs at least.

    Attributes:
        rows: of state and memory.
        operations: of arithmetic, each counted as one.
        copy_seconds: to read and write the rows of the batch once.
        arithmetic_seconds: to do the operations at the rate of a chain of multiplications and additions.
    """

    rows: int
    operations: int
    copy_seconds: float
    arithmetic_seconds: float


def floors(plan: Plan, batches: tuple[int, ...]) -> dict[int, Floor]:
    """Return the floors of the control step that is compiled as a whole, by batch."""
    step = fused(RACING, "rk4", False, plan.device, 5, True)
    rate, rows, operations = operations_per_second(plan.device), step.rows, step.operations
    return {
        batch: Floor(rows, operations, copy_seconds(rows, batch, plan.device), batch * operations / rate)
        for batch in batches
    }


def residual_cost(plan: Plan, batch: int = 10_000) -> dict[str, Laps]:
    """Return the laps with and without a residual of the nearest neighbours, compiled and eager."""
    process = Contender(".venv/bin/python", "benchmarks.ours")
    contenders = {
        f"{path}{', residual' if residual else ''}": ours(
            plan, process, batch=batch, path=path, residual=residual
        )
        for path in ("whole", "eager")
        for residual in (False, True)
    }
    laps = in_turns(contenders, plan.rounds)
    process.close()
    return laps


def effect_costs(plan: Plan, batch: int = 10_000) -> dict[str, tuple[Laps, Laps]]:
    """Return the laps without and with each effect of the catalogue, compiled inner steps of the bare racer."""
    found = {}
    for effect in effects_of("quadrotor"):
        if not isinstance(effect, WrenchEffect | ActuatorEffect):
            continue
        process = Contender(".venv/bin/python", "benchmarks.ours")
        chosen = {"bare": [], "with": [effect.key]}
        contenders = {
            name: ours(plan, process, batch=batch, path="inner", effects=effects)
            for name, effects in chosen.items()
        }
        laps = in_turns(contenders, plan.rounds)
        found[effect.key] = (laps["bare"], laps["with"])
        process.close()
    return found
