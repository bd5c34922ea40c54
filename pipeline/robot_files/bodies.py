"""A robot as bodies in one another: what URDF and MJCF have in common."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True)
class Pose:
    """Where a frame lies in another one.

    Attributes:
        position: of its origin, m, shape (3,).
        rotation: from its axes to those of the other one, shape (3, 3).
    """

    position: np.ndarray = field(default_factory=lambda: np.zeros(3))
    rotation: np.ndarray = field(default_factory=lambda: np.eye(3))

    def then(self, inner: "Pose") -> "Pose":
        """Return the pose of a frame that has the pose `inner` in this one."""
        return Pose(self.of(inner.position), self.rotation @ inner.rotation)

    def of(self, point: np.ndarray) -> np.ndarray:
        """Return a point of this frame in the coordinates of the other one, shape (3,)."""
        return self.position + self.rotation @ point


@dataclass(frozen=True)
class Solid:
    """A rigid mass.

    Attributes:
        mass: kg.
        center: of mass, in the frame of its body, m, shape (3,).
        inertia: about the center of mass, along the axes of the body, kg·m², shape (3, 3).
    """

    mass: float
    center: np.ndarray
    inertia: np.ndarray


@dataclass(frozen=True)
class Controller:
    """A position controller at the joint.

    Attributes:
        proportional: N·m/rad or N/m.
        derivative: N·m·s/rad or N·s/m.
    """

    proportional: float
    derivative: float = 0.0


@dataclass
class Axis:
    """A joint between a body and the one around it.

    Attributes:
        name: of the joint.
        slides: whether it slides; otherwise it turns.
        direction: of its axis in the frame of the body, shape (3,).
        anchor: a point of its axis in the frame of the body, m, shape (3,).
        reference: its position in the pose that the file describes, rad or m.
        armature: inertia of the rotor seen at the joint, kg·m² or kg.
        stiffness: of a spring, N·m/rad or N/m.
        relaxed: its position at which the spring is relaxed, rad or m.
        damping: N·m·s/rad or N·s/m.
        friction: dry, N·m or N.
        effort_limit: N·m or N; None without a limit.
        controller: of a position; None without one.
        damping_ratio: from which the controller's derivative gain follows; None where the gain is given.
        remarks: what else the file says of it, one sentence each.
    """

    name: str
    slides: bool
    direction: np.ndarray
    anchor: np.ndarray = field(default_factory=lambda: np.zeros(3))
    reference: float = 0.0
    armature: float = 0.0
    stiffness: float = 0.0
    relaxed: float = 0.0
    damping: float = 0.0
    friction: float = 0.0
    effort_limit: float | None = None
    controller: Controller | None = None
    damping_ratio: float | None = None
    remarks: list[str] = field(default_factory=list)


@dataclass
class Body:
    """A body with those that it carries.

    Attributes:
        name: for a message.
        pose: in the body around it.
        solids: reads its masses; they may be refused, which matters only where the body moves.
        axes: joints between it and the body around it.
        inner: bodies that it carries.
    """

    name: str
    pose: Pose
    solids: Callable[[], list[Solid]]
    axes: list[Axis] = field(default_factory=list)
    inner: list["Body"] = field(default_factory=list)

    def walk(self, outer: Pose) -> Iterator[tuple["Body", Pose]]:
        """Yield this body and all that it carries, each with its pose in the frame in which `outer` is one."""
        waiting = [(self, outer)]
        while waiting:
            body, around = waiting.pop()
            pose = around.then(body.pose)
            yield body, pose
            waiting += [(inner, pose) for inner in reversed(body.inner)]


@dataclass
class Robot:
    """A robot as its file describes it.

    Attributes:
        file: for a message.
        bodies: that stand on the world.
        gravity: m/s² in the world, shape (3,).
    """

    file: str
    bodies: list[Body]
    gravity: np.ndarray = field(default_factory=lambda: np.array([0.0, 0.0, -9.81]))

    def axes(self) -> Iterator[tuple[Axis, Body, Pose]]:
        """Yield every joint, with the body that it moves and the pose of that body, in the world."""
        for root in self.bodies:
            for body, pose in root.walk(Pose()):
                for axis in body.axes:
                    yield axis, body, pose
