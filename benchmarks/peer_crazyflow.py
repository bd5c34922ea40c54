"""crazyflow: one Crazyflie in each of many worlds, first-principles dynamics, its own rate or attitude controller."""

from typing import Any

import jax
import numpy as np
from crazyflow.control import Control
from crazyflow.drones import Drone
from crazyflow.dynamics import Dynamics
from crazyflow.sim import Sim
from crazyflow.sim.integration import Integrator

from benchmarks.contender import Lap, serve


def make(request: dict[str, Any]) -> Lap:
    """Return laps of control steps at 100 Hz with inner steps at 500 Hz.

    Args:
        request: `batch`, `control` (body_rate or attitude) and `integrator` (euler or rk4).
    """
    batch = request["batch"]
    sim = Sim(
        n_worlds=batch,
        drone=Drone.cf2x_L250,
        dynamics=Dynamics.first_principles,
        control=Control(request["control"]),
        integrator=Integrator(request["integrator"]),
        freq=500,
        device=request.get("device", "cpu"),
    )
    sim.reset()
    hover = 0.0319 * 9.81  # N
    command = np.zeros((batch, 1, 4), dtype=np.float32)
    command[..., 3] = hover
    command = jax.device_put(command, sim.device)
    send = sim.body_rate_control if request["control"] == "body_rate" else sim.attitude_control

    def advance() -> float:
        send(command)
        sim.step(5)
        return 1

    return advance, lambda: jax.block_until_ready(sim.data.states)


if __name__ == "__main__":
    serve(make)
