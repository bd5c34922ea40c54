"""A rotor speed per motor command that differs from the platform file."""

from simgap.effects.effect import ParameterError, Values


class CommandScaleError(ParameterError):
    """The rotor speed per motor command differs from the platform file (ratio of true to nominal)."""

    name = "command_scale_error"
    kind = "quadrotor"
    acts_on = "command"
    spread = 0.1  # half of the logarithm of thrust: speed enters squared
    needs = ("motor_command",)
    formula = "motor_speed_max = ratio · nominal motor_speed_max, Ω = motor_speed_max · command"
    source = "the platform's nominal equations; thrust and reaction torque then change with ratio²"
    sentence = "The rotors turn {ratio} times as fast at a command as the platform file says; correct motor_speed_max."
    excitation = (
        "record the rotor speeds; else yaw quickly to both sides, since a thrust coefficient leaves yaw torques as "
        "they are and a scale of the command does not"
    )
    symptom = (
        "Recorded rotor speeds are off by one factor at every command; without them thrust and all torques are off by "
        "its square."
    )
    # Without rotor speeds a scale is a thrust and a torque coefficient that are wrong by the same factor. Only terms
    # that go with the speed itself tell them apart: rotor drag, the rotors' inertia and the gyroscopic torque.
    look_alikes = ("mass_error", "thrust_coefficient_error")

    def adjust(self, constants: Values, values: Values) -> dict:
        """Return the constants with the rotor speed at full command scaled."""
        return {**constants, "motor_speed_max": values["ratio"] * constants["motor_speed_max"]}
