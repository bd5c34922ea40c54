"""Machines of the concealed plant that somebody else flies: thrust and body rates in, motion out."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from pipeline.platforms import Quadrotor
from pipeline.reality.battery import Battery
from pipeline.reality.case import PlantCase
from pipeline.reality.design import design
from pipeline.reality.flight import STEP, Machines
from pipeline.reality.rotation import Array

Regulator = Callable[[Array, Array], Array]
"""From body rates (runs, 3), rad/s, and a reference (runs, 4), m/s² and rad/s, to rotor speeds (runs, 4), rad/s."""


class RacedMachines:
    """The concealed machine as often as there are runs, each with its own charge, gyro noise and air.

    Attributes:
        runs: how many.
        step: of the plant and its rate controller, s.
    """

    step = STEP

    def __init__(
        self, case: PlantCase, platform: Quadrotor, regulate: Regulator, runs: int, seconds: float, seed: int
    ) -> None:
        """Put them together.

        Args:
            case: what is concealed.
            platform: what the world is told of the machine.
            regulate: the flight controller's rate loop, asked at every step.
            runs: how many.
            seconds: for which they fly at most.
            seed: of every random draw.

        Raises:
            InputError: when the case cannot be flown.
        """
        case.check()
        for_plant, for_charge = (np.random.default_rng([seed, part]) for part in range(2))
        lowest, highest = case.charge
        battery = Battery(platform, for_charge.uniform(lowest, highest, runs), case.battery_wear)
        self.runs, self._regulate = runs, regulate
        self._machines = Machines(
            design(platform, case),
            platform,
            replace(case, runs=runs),
            battery,
            for_plant,
            round(seconds / STEP) + 1,
        )

    def fly(self, state: Array, reference: Array, period: float) -> Array:
        """Return where a command leads.

        Args:
            state: position, velocity (world), attitude, body rate, (runs, 13).
            reference: collective thrust over mass and body rates, held for the period, (runs, 4) m/s² and rad/s.
            period: s.
        """
        self._machines.state = np.array(state, dtype=np.float64)
        for _ in range(round(period / STEP)):
            self._machines.advance(self._regulate(self._machines.felt_rate(), reference))
        return self._machines.state
