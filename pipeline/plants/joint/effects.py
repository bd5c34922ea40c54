"""Concealable effects of a joint. Effort is in N·m or N, position in rad or m."""

import math

from simgap.plants.concealment import Quantity

_EFFORT, _POSITION, _VELOCITY = {"effort": 1}, {"position": 1}, {"velocity": 1}
_PER_VELOCITY = {"effort": 1, "velocity": -1}
_PER_POSITION = {"position": -1}

CONCEALABLE: dict[str, dict[str, Quantity]] = {
    "coulomb_friction": {"level": Quantity("N·m", 0.15, _EFFORT)},
    "viscous_friction": {"coefficient": Quantity("N·m·s/rad", 0.25, _PER_VELOCITY)},
    "stribeck_friction": {
        "extra_level": Quantity("N·m", 0.15, _EFFORT),
        "velocity": Quantity("rad/s", 0.08, _VELOCITY, low=1e-6),
    },
    "quadratic_friction": {"coefficient": Quantity("N·m·s²/rad²", 0.25, {"effort": 1, "velocity": -2})},
    "asymmetric_friction": {"difference": Quantity("N·m", 0.1, _EFFORT, low=-1e4)},
    "load_dependent_friction": {"ratio": Quantity("1", 0.25, high=0.9)},
    "backlash": {
        "gap": Quantity("rad", 0.03, _POSITION),
        "motor_inertia_share": Quantity("1", 0.4, low=0.05, high=0.95),
    },
    "dead_zone": {"width": Quantity("N·m", 0.12, {"command": 1})},  # here in the unit of the command
    "cogging": {
        "amplitude": Quantity("N·m", 0.12, _EFFORT),
        "cycles": Quantity("1/rad", 12.0, _PER_POSITION, low=2.0),  # a magnet has two poles
        "phase": Quantity("rad", 0.7, low=-10.0),
        "second_harmonic": Quantity("1", 0.2),
    },
    "linear_stiffness": {"stiffness": Quantity("N·m/rad", 0.3, {"effort": 1, "position": -1})},
    "cubic_stiffness": {"stiffness": Quantity("N·m/rad³", 0.4, {"effort": 1, "position": -3})},
    "hysteresis": {
        "level": Quantity("N·m", 0.15, _EFFORT),
        "displacement": Quantity("rad", 0.1, _POSITION, low=1e-6),
    },
    "gravity_load": {
        "sine": Quantity("N·m", 0.25, _EFFORT, low=-1e4),
        "cosine": Quantity("N·m", 0.1, _EFFORT, low=-1e4),
    },
    "constant_load": {"load": Quantity("N·m", 0.15, _EFFORT, low=-1e4)},
    "battery_sag": {
        "drop": Quantity("1", 0.2, high=0.6),
        "charge": Quantity("1", 0.8, low=0.05, high=1.0),
    },
    "temperature_derating": {"coefficient": Quantity("1/K", 0.005, high=0.008)},
    "command_delay": {"delay": Quantity("s", 0.02, high=0.1)},
    "motor_lag": {"time_constant": Quantity("s", 0.02, high=0.3)},
    "motor_inductance": {"time_constant": Quantity("s", 0.008, high=0.05)},
    "current_limit": {"limit": Quantity("A", 0.5, {"current": 1}, neutral=math.inf, low=1e-6)},
    "inertia_error": {"ratio": Quantity("1", 1.3, neutral=1.0, low=0.2, high=5.0)},
    "motor_constant_error": {"ratio": Quantity("1", 1.2, neutral=1.0, low=0.2, high=5.0)},
    "input_scale_error": {"ratio": Quantity("1", 1.2, neutral=1.0, low=0.2, high=5.0)},
    "controller_gain_error": {
        "proportional": Quantity("1", 1.3, neutral=1.0, low=0.2, high=5.0),
        "derivative": Quantity("1", 1.3, neutral=1.0, low=0.2, high=5.0),
    },
    "effort_limit": {"limit": Quantity("N·m", 0.6, _EFFORT, neutral=math.inf, low=1e-6)},
    "flexible_coupling": {
        # Damped well, as by rubber or a belt: a position loop that is closed over a shaft like steel's would ring.
        "frequency": Quantity("Hz", 12.0, neutral=math.inf, low=0.5, high=math.inf),
        "damping_ratio": Quantity("1", 0.25, high=1.0),
        "motor_inertia_share": Quantity("1", 0.4, low=0.05, high=0.95),
    },
    "velocity_filter": {"time_constant": Quantity("s", 0.015, high=0.3)},
    "sensor_time_offset": {"offset": Quantity("s", 0.02, low=-0.1, high=0.1)},
}
"""Effects that the catalogue names."""

OUTSIDE: dict[str, dict[str, Quantity]] = {
    "tight_spot": {
        "level": Quantity("N·m", 0.3, _EFFORT),
        "place": Quantity("rad", 0.2, _POSITION, low=-1e4),
        "width": Quantity("rad", 0.1, _POSITION, low=1e-6),
    },
    "wear": {"growth": Quantity("N·m/s", 0.003, _EFFORT)},
    "hard_stop": {"position": Quantity("rad", 0.6, _POSITION, neutral=math.inf)},
    "speed_ripple": {
        "amplitude": Quantity("N·m·s/rad", 0.5, _PER_VELOCITY),
        "cycles": Quantity("1/rad", 3.0, _PER_POSITION, low=1e-6),
    },
}
"""Physics that the catalogue has no name for."""

NEEDS_MOTOR = ("battery_sag", "motor_inductance", "current_limit", "motor_constant_error")
"""Effects of the voltage at a motor: a machine that is driven otherwise does not have them."""

NEEDS_CONTROLLER = ("controller_gain_error", "effort_limit")
"""Effects of a servo that is told a position."""
