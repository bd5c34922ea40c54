"""Coupled dynamics of chassis and wheels: slow masses with stiff tyres.

Advanced by the semi-implicit two-step backward differences (SBDF) of Ascher, Ruuth & Wetton 1995, "Implicit-explicit
methods for time-dependent partial differential equations", §2: second order, tyres implicit, all else extrapolated.
"""

from dataclasses import dataclass, field

import numpy as np

from simgap.plants.concealment import Concealed
from simgap.plants.rotation import Array
from simgap.plants.swerve.tyres import CREEPING, Tyres
from simgap.platforms import Swerve

WHEEL_SHARE = 0.04  # of the robot's mass that is its wheels', rolling, as the person's figures count them in
_NAP_SPEED = 0.05  # m/s, over which a nap lays itself


@dataclass
class Chassis:
    """The robot on its wheels.

    Attributes:
        mass: of the whole without what the wheels' rolling adds, kg.
        weight: of the whole, N.
        matrix: of inertia of the twist [x, y, yaw] about the modules' middle, (3, 3).
        centre: of mass, (2,) m.
        modules: positions (4, 2) m.
        radius: of the wheels, (4,) m.
        wheel: rolling mass of a wheel, inertia over squared radius, kg.
        offsets: of the wheels' directions from the measured angles, (4,) rad.
        tyres: their grip.
        slope: sines of the climb, world frame, (2,).
        nap: force of the carpet's nap on a robot that moves against it, world frame, (2,) N.
        twist: (runs, 3).
        rolling: speed of the treads, (runs, 4) m/s.
        heading: (runs,) rad.
    """

    mass: float
    weight: float
    matrix: Array
    centre: Array
    modules: Array
    radius: Array
    wheel: float
    offsets: Array
    tyres: Tyres
    slope: Array
    nap: Array
    twist: Array
    rolling: Array
    heading: Array
    _before: tuple[Array, ...] | None = field(default=None, repr=False)

    def advance(self, angle: Array, torque: Array, step: float) -> None:
        """Move on by a step.

        Args:
            angle: of the modules as measured, at the end of the step, (runs, 4) rad.
            torque: about the axles, now, (runs, 4) N·m.
            step: s.
        """
        now: tuple[Array, ...] = (self.twist, self.rolling, self._external(), torque / self.radius)
        before = self._before
        if before is None:
            weight, sums, forces = 1.0 / step, [entry / step for entry in now[:2]], list(now[2:])
        else:
            weight = 1.5 / step
            sums = [(2.0 * a - 0.5 * b) / step for a, b in zip(now[:2], before[:2], strict=True)]
            forces = [2.0 * a - b for a, b in zip(now[2:], before[2:], strict=True)]
        guess = now if before is None else [2.0 * a - b for a, b in zip(now[:2], before[:2], strict=True)]
        along, across = self._directions(angle)
        stiff_along, stiff_across = self._damping(guess[0], guess[1], along, across, step)
        push = self.wheel * sums[1] + forces[1]
        share = stiff_along / (weight * self.wheel + stiff_along)
        matrix = weight * self.matrix + _weighted(along, share * weight * self.wheel)
        matrix = matrix + _weighted(across, stiff_across)
        right = sums[0] @ self.matrix + forces[0] + ((share * push)[..., None] * along).sum(axis=1)
        self._before = now
        self.twist = np.linalg.solve(matrix, right[..., None])[..., 0]
        over = (along * self.twist[:, None]).sum(axis=-1)
        self.rolling = (push + stiff_along * over) / (weight * self.wheel + stiff_along)
        self.heading = self.heading + 0.5 * step * (now[0][:, 2] + self.twist[:, 2])

    def _external(self) -> Array:
        """Return what acts on the twist besides tyres: the turning frame, the slope and the nap, (runs, 3)."""
        x, y, yaw = self.twist.T
        cosine, sine = np.cos(self.heading), np.sin(self.heading)
        world = -self.weight * self.slope[:, None] + self._nap(x * cosine - y * sine, x * sine + y * cosine)
        push_x, push_y = world[0] * cosine + world[1] * sine, world[1] * cosine - world[0] * sine
        turn = self.centre[0] * push_y - self.centre[1] * push_x
        return np.stack(
            (
                push_x + self.mass * yaw * (y + yaw * self.centre[0]),
                push_y - self.mass * yaw * (x - yaw * self.centre[1]),
                turn - self.mass * yaw * (self.centre[0] * x + self.centre[1] * y),
            ),
            axis=-1,
        )

    def _nap(self, x: Array, y: Array) -> Array:
        """Return the force (2, runs), N, world frame, of a nap that leans one way, at a velocity (runs,) m/s."""
        size = np.hypot(*self.nap)
        if size == 0:
            return np.zeros((2, 1))
        against = (self.nap[0] * x + self.nap[1] * y) / size
        return -self.nap[:, None] * np.maximum(np.tanh(against / _NAP_SPEED), 0.0)

    def _directions(self, angle: Array) -> tuple[Array, Array]:
        """Return the rows from the twist to the speed along and across each wheel, (runs, 4, 3)."""
        cosine, sine = np.cos(angle + self.offsets), np.sin(angle + self.offsets)
        x, y = self.modules.T
        along = np.stack((cosine, sine, x * sine - y * cosine), axis=-1)
        return along, np.stack((-sine, cosine, x * cosine + y * sine), axis=-1)

    def _damping(
        self, twist: Array, rolling: Array, along: Array, across: Array, step: float
    ) -> tuple[Array, Array]:
        over = (along * twist[:, None]).sum(axis=-1)
        slip = np.stack((rolling - over, (across * twist[:, None]).sum(axis=-1)))
        if self._before is None or not self.tyres.height:
            acceleration = np.zeros((len(twist), 2))
        else:
            x, y, yaw = self.twist.T
            pace = (self.twist - self._before[0]) / step
            acceleration = np.stack((pace[:, 0] - yaw * y, pace[:, 1] + yaw * x), axis=-1)
        loads = self.tyres.loads(self.weight, self.mass, acceleration, self.modules)
        return self.tyres.damping(slip, rolling, loads)


def _weighted(rows: Array, weights: Array) -> Array:
    """Return the sum over wheels of weight times the square of its row, (runs, 3, 3)."""
    return (weights[..., None] * rows).swapaxes(-1, -2) @ rows


def chassis_of(effects: Concealed, outside: Concealed, platform: Swerve, runs: int) -> Chassis:
    """Return the robot that a case conceals, at rest.

    What wheels add by rolling acts along the allowed motion as masses at the modules would; the platform's mass and
    inertia count it in, and the plant takes it from there.
    """
    modules = np.array(platform.module_positions)
    whole = platform.mass * effects.get("mass_error@drive", "ratio")
    wheel = 0.25 * WHEEL_SHARE * whole
    mass = whole - 4.0 * wheel
    inertia = platform.inertia * effects.get("inertia_error@drive", "ratio") - wheel * (modules**2).sum()
    centre = np.array([outside.get("center_of_mass_offset", axis) for axis in "xy"])
    x, y = mass * centre
    matrix = np.array([[mass, 0.0, -y], [0.0, mass, x], [-y, x, inertia + mass * (centre @ centre)]])
    radius = np.full(4, platform.wheel_radius * effects.get("wheel_radius_error@drive", "ratio"))
    radius[0] *= outside.get("uneven_wheel", "ratio")
    direction = outside.get("carpet_nap", "direction")
    return Chassis(
        mass=mass,
        weight=whole * platform.gravity,
        matrix=matrix,
        centre=centre,
        modules=modules,
        radius=radius,
        wheel=wheel,
        offsets=np.array([effects.get("module_misalignment@chassis", f"offset_{n}") for n in range(1, 5)]),
        tyres=_tyres_of(effects),
        slope=np.array([effects.get("slope@chassis", f"rise_{axis}") for axis in "xy"]),
        nap=outside.get("carpet_nap", "force") * np.array([np.cos(direction), np.sin(direction)]),
        twist=np.zeros((runs, 3)),
        rolling=np.zeros((runs, 4)),
        heading=np.zeros(runs),
    )


def _tyres_of(effects: Concealed) -> Tyres:
    """Return the grip of the wheels: how they creep, where they slide, and how load shifts as they do."""
    cornering = effects.get("module_misalignment@chassis", "cornering_stiffness")
    friction = effects.get("wheel_slip@drive", "friction_coefficient")
    compliance = effects.get("tyre_creep@drive", "compliance")
    if compliance > 0:
        height = effects.get("tyre_creep@drive", "height")
        return Tyres(friction, 1.0 / compliance, height, cornering, CREEPING)
    if "wheel_slip@drive" in effects:
        stiffness, height = (effects.get("wheel_slip@drive", name) for name in ("stiffness", "height"))
        return Tyres(friction, stiffness, height, cornering)
    return Tyres(friction, 0.0, 0.0, cornering, CREEPING)
