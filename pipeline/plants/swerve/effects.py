"""Concealable effects of a swerve drive; the part after `@` is the group."""

import math

from simgap.plants.concealment import Quantity

# Of the typical torque: friction in a drive train, and under a module that carries the robot's weight.
_GROUPS = {"drive": ("wheel_torque", "wheel_speed", 0.2), "steer": ("module_torque", "module_rate", 0.4)}


def _in_both() -> dict[str, dict[str, Quantity]]:
    """Return the effects that wheels and modules may have alike."""
    effects: dict[str, dict[str, Quantity]] = {}
    for group, (torque, speed, share) in _GROUPS.items():
        effects |= {
            f"coulomb_friction@{group}": {"level": Quantity("N·m", share, {torque: 1})},
            f"viscous_friction@{group}": {
                "coefficient": Quantity("N·m·s/rad", share, {torque: 1, speed: -1})
            },
            f"stribeck_friction@{group}": {
                "extra_level": Quantity("N·m", share, {torque: 1}),
                "velocity": Quantity("rad/s", 0.12, {speed: 1}, low=1e-6),
            },
            f"battery_sag@{group}": {
                "drop": Quantity("1", 0.15, high=0.6),
                "charge": Quantity("1", 0.8, low=0.05, high=1.0),
            },
            f"command_delay@{group}": {"delay": Quantity("s", 0.02, high=0.1)},
            f"motor_inductance@{group}": {"time_constant": Quantity("s", 0.01, high=0.05)},
            f"current_limit@{group}": {
                "limit": Quantity("A", 0.8, {f"{group}_current": 1}, neutral=math.inf, low=1e-6)
            },
            f"motor_constant_error@{group}": {"ratio": Quantity("1", 1.2, neutral=1.0, low=0.2, high=5.0)},
        }
    return effects


CONCEALABLE: dict[str, dict[str, Quantity]] = {
    **_in_both(),
    "backlash@steer": {
        "gap": Quantity("rad", 0.02),
        "motor_inertia_share": Quantity("1", 0.6, low=0.05, high=0.95),
    },
    "drive_steer_coupling@drive": {"ratio": Quantity("1", 2.0, low=-50.0, high=50.0)},
    "scrub_torque@steer": {
        "level": Quantity("N·m", 1.5, {"module_torque": 1}),
        "patch_radius": Quantity("m", 0.02, low=1e-3),
    },
    "wheel_slip@drive": {
        "friction_coefficient": Quantity("1", 0.8, {"grip": 1}, neutral=math.inf, low=1e-3),
        "stiffness": Quantity("1", 40.0, low=1.0),
        "height": Quantity("m", 0.3, {"track": 1}),
    },
    "tyre_creep@drive": {
        "compliance": Quantity("1", 0.04, high=0.5),
        "height": Quantity("m", 0.3, {"track": 1}),
    },
    "module_misalignment@chassis": {
        "offset_1": Quantity("rad", 0.06, low=-0.8, high=0.8),
        "offset_2": Quantity("rad", 0.0, low=-0.8, high=0.8),
        "offset_3": Quantity("rad", 0.0, low=-0.8, high=0.8),
        "offset_4": Quantity("rad", 0.0, low=-0.8, high=0.8),
        "cornering_stiffness": Quantity("1/rad", 15.0, low=1.0, high=100.0),
    },
    "slope@chassis": {
        "rise_x": Quantity("1", 0.05, low=-0.5, high=0.5),
        "rise_y": Quantity("1", 0.0, low=-0.5, high=0.5),
    },
    "wheel_radius_error@drive": {"ratio": Quantity("1", 0.93, neutral=1.0, low=0.2, high=5.0)},
    "mass_error@drive": {"ratio": Quantity("1", 1.25, neutral=1.0, low=0.2, high=5.0)},
    "inertia_error@drive": {"ratio": Quantity("1", 1.35, neutral=1.0, low=0.2, high=5.0)},
    "sensor_time_offset@chassis": {"offset": Quantity("s", 0.02, low=-0.1, high=0.1)},
}
"""Effects that the catalogue names."""

OUTSIDE: dict[str, dict[str, Quantity]] = {
    "carpet_nap": {
        "force": Quantity("N", 0.25, {"force": 1}),
        "direction": Quantity("rad", 0.6, low=-10.0),
    },
    "center_of_mass_offset": {
        "x": Quantity("m", 0.25, {"track": 1}, low=-10.0),
        "y": Quantity("m", 0.0, low=-10.0),
    },
    "uneven_wheel": {"ratio": Quantity("1", 0.93, neutral=1.0, low=0.5, high=2.0)},
    "steering_spot": {
        "level": Quantity("N·m", 0.7, {"module_torque": 1}),
        "place": Quantity("rad", 0.0, low=-100.0),
        "width": Quantity("rad", 0.25, low=1e-6),
    },
    "steering_magnet": {
        "amplitude": Quantity("N·m", 0.4, {"module_torque": 1}),
        "cycles": Quantity("1/rad", 6.0, low=1e-6),
    },
}
"""Physics that the catalogue has no name for."""
