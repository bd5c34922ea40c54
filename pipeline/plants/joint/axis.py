"""Moving masses of a joint: one, or motor and load with backlash or a soft shaft."""

from dataclasses import dataclass

import numpy as np

from simgap.plants.concealment import Concealed
from simgap.plants.joint.case import JointCase
from simgap.plants.joint.friction import Friction, friction_of
from simgap.plants.joint.hysteresis import bouc_wen
from simgap.plants.joint.load import Load, load_of
from simgap.plants.rotation import Array
from simgap.platforms import Joint

CONTACT_FREQUENCY = 600.0  # rad/s, of motor against load on the teeth
_CONTACT_DAMPING_RATIO = 0.3
_HARDENING = (
    0.1  # growth of a shaft's stiffness at the twist that a typical effort makes, as of a rubber coupling
)


@dataclass(frozen=True)
class Coupling:
    """What joins motor and load.

    Nordin & Gutman 2002, "Controlling mechanical systems with backlash: a survey", §2: a shaft with stiffness and
    damping behind a gap; teeth push and never pull.

    Attributes:
        gap: total play, rad or m; 0 for a shaft that is joined for good.
        stiffness: at small twists, N·m/rad.
        damping: N·m·s/rad.
        hardening: of the stiffness with the square of the twist, 1/rad² or 1/m².
    """

    gap: float
    stiffness: float
    damping: float
    hardening: float = 0.0

    def effort(self, twist: Array, rate: Array) -> Array:
        """Return what the motor does to the load, N·m or N."""
        wound = twist - np.clip(twist, -0.5 * self.gap, 0.5 * self.gap)
        push = self.stiffness * wound * (1.0 + self.hardening * wound * wound) + self.damping * rate
        if not self.gap:
            return push
        return np.where(push * wound > 0, push, 0.0)


@dataclass
class Axis:
    """The masses and everything on them that has a state.

    Attributes:
        inertia: (bodies, 1), motor first, load last.
        coupling: between two bodies; None for one.
        friction: on the load.
        load: on the load.
        age: for how long each run's machine had run at its start, (runs,) s.
        position: (bodies, runs) rad or m.
        velocity: same shape, rad/s or m/s.
        acceleration: same shape.
        foreseen: the velocity that the last acceleration leads to, same shape.
        bristles: deflection, (runs,).
        strain: of the hysteretic part, (runs,).
        effort: of the motor, (runs,).
        transmitted: what last reached the load, (runs,).
        external: what else pushes on the load, (runs,).
    """

    inertia: Array
    coupling: Coupling | None
    friction: Friction
    load: Load
    age: Array
    position: Array
    velocity: Array
    acceleration: Array
    foreseen: Array
    bristles: Array
    strain: Array
    effort: Array
    transmitted: Array
    external: Array

    def travel(self, step: float) -> None:
        """Move on by a step; the velocity goes half the way, `push` completes it."""
        self.foreseen = self.velocity + step * self.acceleration
        self.velocity = self.velocity + 0.5 * step * self.acceleration
        self.position = self.position + step * self.velocity
        self.age = self.age + step
        moving = self.velocity[-1]
        if self.friction.dry:
            self.bristles = self.friction.bend(self.bristles, moving, self._level(moving), step)
        if self.load.hysteresis[0]:
            self.strain = bouc_wen(self.strain, step * moving, self.load.hysteresis[1])

    def push(self, effort: Array, step: float) -> None:
        """Complete a step with the motor's effort (runs,) at its end, N·m or N."""
        self.acceleration = self._accelerations(effort, self.foreseen)
        self.velocity = self.velocity + 0.5 * step * self.acceleration

    def feel(self, effort: Array) -> None:
        """Take an effort that has jumped, without letting time pass."""
        self.acceleration = self._accelerations(effort, self.velocity)

    def _level(self, velocity: Array) -> Array:
        return self.friction.level(velocity, self.position[-1], self.transmitted, self.age)

    def _accelerations(self, effort: Array, velocity: Array) -> Array:
        self.effort = effort
        moving = velocity[-1]
        force = self.external + self.load.force(self.position[-1], moving, self.strain)
        if self.friction.speed_dependent:
            force = force + self.friction.speed_force(moving)
        if self.friction.dry:
            force = force + self.friction.dry_force(self.bristles, moving, self._level(moving))
        if self.coupling is None:
            self.transmitted = effort
            return (effort + force)[None] / self.inertia
        twist, rate = self.position[0] - self.position[1], velocity[0] - velocity[1]
        self.transmitted = self.coupling.effort(twist, rate)
        return np.stack((effort - self.transmitted, self.transmitted + force)) / self.inertia


def axis_of(
    effects: Concealed, outside: Concealed, platform: Joint, case: JointCase, start: tuple[Array, Array]
) -> Axis:
    """Return the axis that a case conceals, at a position and velocity (runs,)."""
    inertia = platform.inertia * effects.get("inertia_error", "ratio")
    effort = case.size(platform)["effort"]
    shares, coupling = bodies(effects, inertia, effort)
    resting = np.zeros(case.runs)
    position, velocity = (np.tile(series, (len(shares), 1)) for series in start)
    return Axis(
        inertia=inertia * shares,
        coupling=coupling,
        friction=friction_of(effects, outside, inertia, effort),
        load=load_of(effects, outside, platform.gravity_torque, platform.stiffness, inertia),
        age=case.duration * np.arange(case.runs, dtype=np.float64),
        position=position,
        velocity=velocity,
        acceleration=np.zeros_like(position),
        foreseen=velocity,
        bristles=resting,
        strain=resting,
        effort=resting,
        transmitted=resting,
        external=resting,
    )


def bodies(effects: Concealed, inertia: float, effort: float) -> tuple[Array, Coupling | None]:
    """Return the shares of the inertia (bodies, 1) and what joins them.

    Args:
        effects: with `backlash` or `flexible_coupling`, perhaps.
        inertia: of both, kg·m² or kg.
        effort: typical, N·m or N.
    """
    if "backlash" in effects:
        share = effects.get("backlash", "motor_inertia_share")
        swinging = inertia * share * (1.0 - share)  # both bodies swing against each other
        stiffness, damping = _spring(swinging, CONTACT_FREQUENCY, _CONTACT_DAMPING_RATIO)
        coupling = Coupling(effects.get("backlash", "gap"), stiffness, damping)
    elif "flexible_coupling" in effects and np.isfinite(effects.get("flexible_coupling", "frequency")):
        share = effects.get("flexible_coupling", "motor_inertia_share")
        frequency = 2.0 * np.pi * effects.get("flexible_coupling", "frequency")
        ratio = effects.get("flexible_coupling", "damping_ratio")
        stiffness, damping = _spring(inertia * (1.0 - share), frequency, ratio)  # the motor is held
        coupling = Coupling(0.0, stiffness, damping, _HARDENING * (stiffness / effort) ** 2)
    else:
        return np.ones((1, 1)), None
    return np.array([[share], [1.0 - share]]), coupling


def _spring(inertia: float, frequency: float, damping_ratio: float) -> tuple[float, float]:
    """Return the stiffness and damping on which an inertia swings at a frequency, rad/s."""
    return inertia * frequency**2, 2.0 * damping_ratio * inertia * frequency
