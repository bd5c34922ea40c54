"""State of a quadrotor recorded on another clock than the motors."""

from simgap.effects.time_offset import TimeOffset


class QuadrotorTimeOffset(TimeOffset):
    """The state reaches the log late with respect to the motors' telemetry (early where negative)."""

    kind = "quadrotor"
    needs = ("rotor_speed",)
    on_command_clock = ("rotor_speed", "motor_command")
    excitation = "pump the thrust up and down quickly, so that rotor speed and acceleration can be aligned"
