"""Time offset between the state of a quadrotor and its motors."""

from simgap.effects.time_offset import TimeOffset


class QuadrotorTimeOffset(TimeOffset):
    """The state is recorded late relative to the motors' telemetry, or early if negative."""

    kind = "quadrotor"
    needs = ("rotor_speed",)
    on_command_clock = ("rotor_speed", "motor_command")
    excitation = "change the thrust quickly up and down, so that rotor speed and acceleration can be aligned"
