"""This project's racing quadrotor: rate controller, battery, speed controllers, motors and aerodynamics."""

import functools
from typing import Any

import torch
import yaml
from torch import Tensor

from benchmarks.contender import ROOT, Lap, serve
from simgap.effects import effect_by_key
from simgap.platforms import Quadrotor, platform_from_config
from simgap.simulation import FittedEffect
from simgap.simulation.flight import Flight, Memory, racing_flight
from simgap.simulation.fused import FusedStep
from simgap.simulation.knn_residual import NearestNeighbours

RACING = ("grey_box_aerodynamics", "rotor_inertia_torque")
_SAMPLES = 1000


@functools.cache
def racer() -> Quadrotor:
    """Return the platform."""
    text = (ROOT / "conf" / "platform" / "racer.yaml").read_text(encoding="utf-8")
    platform = platform_from_config(yaml.safe_load(text))
    assert isinstance(platform, Quadrotor)
    return platform


def flight(effects: tuple[str, ...], integrator: str, residual: bool, device: str, substeps: int) -> Flight:
    """Return the racer with effects of the catalogue at their default strength."""
    fitted = tuple(
        FittedEffect(e, e.defaults()) for e in (effect_by_key("quadrotor", key) for key in effects)
    )
    samples = None
    if residual:
        random = torch.Generator().manual_seed(0)
        inputs = torch.randn(_SAMPLES, 7, generator=random).to(device)
        samples = NearestNeighbours(inputs, 0.1 * torch.randn(_SAMPLES, 6, generator=random).to(device))
    return racing_flight(racer(), fitted, residual=samples, integrator=integrator, substeps=substeps)


def started(flying: Flight, batch: int, device: str) -> tuple[Tensor, Tensor, Memory]:
    """Return state, action and memory of a batch after its first period."""
    random = torch.Generator().manual_seed(1)
    state = torch.zeros(batch, 13)
    state[:, 3] = 1.0
    state[:, 7:] = torch.randn(batch, 6, generator=random)
    action = torch.cat([torch.full((batch, 1), 9.81), 0.3 * torch.randn(batch, 3, generator=random)], dim=1)
    state, action = state.to(device), action.to(device)
    with torch.no_grad():
        return (*_reordered(flying.step(state, action), action),)


def _reordered(stepped: tuple[Tensor, Memory], action: Tensor) -> tuple[Tensor, Tensor, Memory]:
    return stepped[0], action, stepped[1]


@functools.cache
def fused(
    effects: tuple[str, ...], integrator: str, residual: bool, device: str, substeps: int, whole: bool
) -> FusedStep:
    """Return the compiled step: of the whole control step, or of an inner one that is repeated."""
    flying = flight(effects, integrator, residual, device, substeps)
    state, action, memory = started(flying, 2, device)
    acting = flying.acting(state, action)
    if not whole:
        return FusedStep(flying.inner_step, state, acting, memory, repeats=flying.substeps)

    def control_step(state: Tensor, acting: Tensor, memory: Any) -> tuple[Tensor, Any]:
        for _ in range(flying.substeps):
            state, memory = flying.inner_step(state, acting, memory)
        return state, memory

    return FusedStep(control_step, state, acting, memory)


def make(request: dict[str, Any]) -> Lap:
    """Return laps of control steps.

    Args:
        request: `batch`, `path` (eager, inner or whole: what is compiled into one loop), `integrator`, `effects`,
            `residual`, `device` and `substeps` (five unless given).
    """
    device = request.get("device", "cpu")
    wait = torch.cuda.synchronize if device == "cuda" else lambda: None
    options = (
        tuple(request["effects"]),
        request["integrator"],
        request.get("residual", False),
        device,
        request.get("substeps", 5),
    )
    flying = flight(*options)
    state, action, memory = started(flying, request["batch"], device)
    if request["path"] == "eager":
        return _eager(flying, state, action, memory), wait
    step = fused(*options, request["path"] == "whole")
    return _fused(flying, step, step.pack(state, memory), action), wait


def _eager(flying: Flight, state: Tensor, action: Tensor, memory: Memory) -> Any:
    @torch.no_grad()
    def advance() -> float:
        nonlocal state, memory
        state, memory = flying.step(state, action, memory)
        return 1

    return advance


def _fused(flying: Flight, step: FusedStep, rows: Tensor, action: Tensor) -> Any:
    commanded = action.T.contiguous()

    @torch.no_grad()
    def advance() -> float:
        nonlocal rows
        acting = commanded
        if flying.residual is not None:
            acting = flying.acting(rows[:13].T, action).T.contiguous()
        rows = step(rows, acting)
        return 1

    return advance


if __name__ == "__main__":
    serve(make)
