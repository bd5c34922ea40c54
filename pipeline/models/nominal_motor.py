"""The feedforward constants that a platform's data sheet implies."""

from simgap.platforms import Joint, Platform, Swerve


def nominal_feedforward(platform: Platform, motor: str) -> dict[str, float]:
    """Return kS, kV, kA and the gains of a joint's loads, by its recorded speed; empty where no motor is described.

    From V = R·i + k·N·v and J·dv/dt = N·k·i: kV = k·N, kA = R·J/(N·k). Data sheets know no friction: kS = 0.

    Args:
        platform: a joint, or a swerve drive, whose drive motors carry a quarter of the mass each.
        motor: `drive_N` or `steer_N` for a swerve drive; any name for a joint.
    """
    if isinstance(platform, Joint) and platform.motor is not None:
        gain = platform.motor.torque_constant * platform.motor.gear_ratio
        per_torque = platform.motor.resistance / gain
        loads = {"kG": platform.gravity_torque * per_torque, "kSpring": platform.stiffness * per_torque}
        return _constants(gain, platform.inertia * per_torque) | loads
    if isinstance(platform, Swerve):
        axis = platform.drive if motor.startswith("drive") else platform.steer
        speed, torque = axis.motor.back_emf_constant, axis.motor.torque_constant
        if axis is platform.steer:
            inertia = axis.motor.resistance * axis.inertia / (axis.gear_ratio * torque)
            return _constants(speed * axis.gear_ratio, inertia)
        carried = platform.mass / 4 * (platform.wheel_radius / axis.gear_ratio) ** 2
        return _constants(speed, axis.motor.resistance * carried / torque)
    return {}


def _constants(speed: float, acceleration: float) -> dict[str, float]:
    return {"kS": 0.0, "kV": speed, "kA": acceleration}
