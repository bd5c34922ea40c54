"""rotorpy: a batch of Crazyflies with aerodynamics, its own rate controller, fourth-order Runge–Kutta."""

from typing import Any

import torch
from rotorpy.vehicles.crazyflie_params import quad_params
from rotorpy.vehicles.multirotor import BatchedMultirotor, BatchedMultirotorParams

from benchmarks.contender import Lap, serve


def make(request: dict[str, Any]) -> Lap:
    """Return laps of inner steps.

    Args:
        request: `batch` and `inner`, the inner steps in a control step of 10 ms.
    """
    batch, inner = request["batch"], request["inner"]
    device = torch.device(request.get("device", "cpu"))
    state = {
        "x": torch.zeros(batch, 3, device=device).double(),
        "v": torch.zeros(batch, 3, device=device).double(),
        "q": torch.tensor([0.0, 0.0, 0.0, 1.0], device=device).double().repeat(batch, 1),
        "w": torch.zeros(batch, 3, device=device).double(),
        "wind": torch.zeros(batch, 3, device=device).double(),
        "rotor_speeds": torch.full((batch, 4), 1788.5, device=device).double(),
    }
    parameters = BatchedMultirotorParams([quad_params] * batch, batch, device)
    vehicle = BatchedMultirotor(
        parameters, batch, state, device, control_abstraction="cmd_ctbr", aero=True, integrator="rk4"
    )
    control = {
        "cmd_thrust": torch.full((batch, 1), quad_params["mass"] * 9.81, device=device).double(),
        "cmd_w": torch.zeros(batch, 3, device=device).double(),
    }
    everyone = list(range(batch))

    @torch.no_grad()
    def advance() -> float:
        nonlocal state
        state = vehicle.step(state, control, 0.01 / inner, everyone)
        return 1 / inner

    return advance, torch.cuda.synchronize if device.type == "cuda" else lambda: None


if __name__ == "__main__":
    serve(make)
