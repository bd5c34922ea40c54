"""Tyre forces from slip."""

from dataclasses import dataclass

import numpy as np

from simgap.plants.rotation import Array

# Where no slip is concealed, none that a sensor sees. Along the wheel it may be as stiff as arithmetic likes; across,
# wheels that disagree by a thousandth of a rad must not fight each other harder than real ones do.
_ALONG, _ACROSS = 2e3, 4e2  # N of force per m/s of slip and per N of load
_CREEP_SPEED = 0.15  # m/s, below which stiffness no longer grows as speed falls
CREEPING = 0.05
"""m/s, the same where creep or a side force is concealed: the force follows slip ratio and slip angle at nearly all
speeds, as it does for tyres (Pacejka 2012, §1.2)."""


@dataclass(frozen=True)
class Tyres:
    """The grip of four wheels.

    Pacejka 2012, "Tire and vehicle dynamics", §1.2: force in proportion to slip, together along and across, up to the
    friction circle.

    Attributes:
        friction: greatest force over load; infinite where wheels never slide.
        stiffness: force over load and slip ratio (rad of slip angle); 0 for wheels that hardly slip at all.
        height: of the centre of mass, m, by which braking and curves shift load.
        cornering: side force over load and slip angle of wheels that hardly slip otherwise, 1/rad; 0 where they point
            so well that none shows.
        creep_speed: m/s, below which stiffness no longer grows as speed falls.
    """

    friction: float
    stiffness: float
    height: float
    cornering: float = 0.0
    creep_speed: float = _CREEP_SPEED

    def loads(self, weight: float, mass: float, acceleration: Array, modules: Array) -> Array:
        """Return the load on each wheel (runs, 4), N, never less than a tenth of its share.

        Args:
            weight: N.
            mass: kg.
            acceleration: of the centre of mass, robot frame, (runs, 2) m/s².
            modules: positions (4, 2), m.
        """
        even = 0.25 * weight
        shifted = even - mass * self.height * (acceleration / (modules**2).sum(axis=0)) @ modules.T
        return np.maximum(shifted, 0.1 * even)

    def damping(self, slip: Array, rolling: Array, loads: Array) -> tuple[Array, Array]:
        """Return force per slip speed along and across each wheel, (runs, 4) N·s/m.

        Args:
            slip: speed of the tread over the ground along and across, (2, runs, 4) m/s.
            rolling: speed of the wheel, (runs, 4) m/s.
            loads: (runs, 4) N.
        """
        if not self.stiffness:
            return _ALONG * loads, self._side_stiffness(rolling) * loads
        linear = self.stiffness / np.hypot(rolling, self.creep_speed)
        sliding = np.sqrt((slip * slip).sum(axis=0))
        grip = loads * linear / np.sqrt(1.0 + (linear * sliding / self.friction) ** 2)
        return grip, grip

    def _side_stiffness(self, rolling: Array) -> Array:
        """Return side force over load per slip speed across wheels that roll at a speed (runs, 4) m/s."""
        if not self.cornering:
            return np.full_like(rolling, _ACROSS)
        return np.minimum(self.cornering / np.hypot(rolling, self.creep_speed), _ACROSS)
