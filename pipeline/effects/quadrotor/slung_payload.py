"""Load that swings below the machine on a cable."""

from typing import Any

import torch
from torch import Tensor

from simgap.effects.chain import chains_of
from simgap.effects.effect import ActuatorEffect, Parameter, Signals, Values, WrenchEffect
from simgap.effects.first_swing import first_swing
from simgap.effects.quadrotor.common import along_axes
from simgap.effects.scan import scan
from simgap.physics import rotations
from simgap.physics.cable import Cable, along, pull, swing
from simgap.physics.shapes import Channels, Signal

_TOGETHER = 4  # blocks over which one swing is simulated: the sensors limit the precision beyond


class SlungPayload(ActuatorEffect, WrenchEffect):
    """A point mass swings freely on a light taut cable from the centre of mass."""

    remembers = True
    linear = False
    order = 3
    name = "slung_payload"
    kind = "quadrotor"
    acts_on = "force"
    parameters = (
        Parameter("mass_ratio", "1", 0.1, 0.0, 1.0),
        Parameter("length", "m", 0.8, 0.1, 5.0, neutral=1.0, alike=True),
    )
    needs = ("attitude", "velocity")
    formula = (
        "with q the cable's direction and b = g − dv/dt the apparent gravity: length·d²q/dt² = b − (q·b)·q − "
        "length·|dq/dt|²·q; a = mass_ratio · max(length·|dq/dt|² + q·b, 0) · q"
    )
    source = (
        "Sreenath, Michael & Kumar 2013, Trajectory generation and control of a quadrotor with a cable-suspended "
        "load, §II"
    )
    sentence = (
        "A load of {mass_ratio} times the machine's mass swings on a cable of {length} m; add the pendulum to"
        " the simulator."
    )
    excitation = "dash, stop, and wait for several swings"
    symptom = "After a stop the machine sways at a fixed frequency without a command."
    look_alikes = ("mass_error",)

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan over the length: each swing gained or lost gives a local minimum."""
        return scan(mass_ratio=(0.05,), length=(0.15, 0.25, 0.4, 0.6, 0.9, 1.4, 2.2, 3.5))

    def actuate(
        self, signals: Signals, values: Values, constants: Values, memory: Any, time_step: float
    ) -> tuple[dict[str, Signal], Any]:
        """Return the cable's pull per mass of the load; the cable hangs straight at the first sample.

        The memory holds the cable's direction and rate, the machine's velocity and the pull, all in the world frame.
        The recorded acceleration contains the previous pull. It is removed, and the rest is shared by mass.
        """
        velocity = rotations.rotate(signals["attitude"], signals["velocity"])
        weight = _weight(velocity, constants)
        if memory is None:
            direction, rate = along(weight), torch.zeros_like(weight)
            bare = apparent = weight
            share = 1.0
        else:
            direction, rate, before, pulled = memory
            apparent = weight - (velocity - before) / time_step
            bare = apparent + values["mass_ratio"] * pulled
            share = 1.0 / (1.0 + values["mass_ratio"])
            direction, rate = swing(direction, rate, apparent, apparent, values["length"], time_step)
        pulled = share * pull(direction, rate, bare, values["length"])
        return {"payload_pull": pulled}, (direction, rate, velocity, pulled)

    def along_time(
        self, signals: Signals, values: Values, constants: Values, time_step: float
    ) -> dict[str, Signal]:
        """Return recorded blocks with the pull that follows from the machine's recorded acceleration.

        The acceleration is that of the accelerometer, or else central differences of the velocity. The swing continues
        from block to block. Its initial state is fitted to the forces across the thrust.
        """
        chains = chains_of(signals, time_step, _TOGETHER)
        apparent = _apparent_gravity(signals, constants, time_step)
        joined = chains.joined(apparent)
        cable = Cable(values["length"], constants["gravity"], time_step)
        start = along(joined[:, 0]), torch.zeros_like(joined[:, 0])
        if "run_number" in signals:
            attitude = chains.joined(signals["attitude"])
            start = first_swing(cable, joined, attitude, chains.recorded, values["mass_ratio"])
        direction, rate = (chains.parted(series) for series in cable.swings(*start, joined))
        return {**signals, "payload_pull": pull(direction, rate, apparent, values["length"])}

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return the cable's pull on the machine in the body frame, m/s²."""
        pulled = rotations.rotate_inverse(signals["attitude"], signals["payload_pull"])
        return along_axes("force", values["mass_ratio"] * pulled)


def _weight(like: Tensor, constants: Values) -> Tensor:
    down = torch.zeros_like(like)
    down[..., 2] = -constants["gravity"]
    return down


def _apparent_gravity(signals: Signals, constants: Values, time_step: float) -> Tensor:
    """Return gravity less the machine's acceleration along blocks, world frame (blocks, samples, 3), m/s²."""
    if "specific_force" in signals:
        return -rotations.rotate(signals["attitude"], signals["specific_force"])
    velocity = rotations.rotate(signals["attitude"], signals["velocity"])
    (acceleration,) = torch.gradient(velocity, spacing=time_step, dim=1)
    return _weight(velocity, constants) - acceleration
