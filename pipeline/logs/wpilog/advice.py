"""How to log what a robot's log lacks, in one sentence each."""

VOLTS = (
    "log the volts of each motor: getMotorVoltage() of a TalonFX, getAppliedOutput() * getBusVoltage() of a Spark, "
    "as AdvantageKit's AppliedVolts"
)
NO_DUTY = "{} is a duty, and a duty is no voltage"
SWERVE: dict[str, str] = {
    "drive_voltage": f"{VOLTS} under /Drive/Module0/DriveAppliedVolts",
    "steer_voltage": f"{VOLTS} under /Drive/Module0/TurnAppliedVolts",
    "drive_velocity": "log the speed of each drive motor in rad/s, as /Drive/Module0/DriveVelocityRadPerSec, "
    "or measured SwerveModuleStates",
    "steer_velocity": "log the speed of each steering axis in rad/s, as /Drive/Module0/TurnVelocityRadPerSec",
    "steer_angle": "log the angle of each module, as /Drive/Module0/TurnPosition, or measured SwerveModuleStates",
}
JOINT: dict[str, str] = {
    "voltage": f"{VOLTS}, or run a SysIdRoutine",
    "position": "log the position of the axis in rad or m, as /Arm/PositionRad, or run a SysIdRoutine",
    "velocity": "log the speed of the axis in rad/s or m/s, as /Arm/VelocityRadPerSec, or run a SysIdRoutine",
}
HOW = "docs/how_to/frc.md shows the robot's code"
