"""Damaged rotor: chipped, bent, loose or on a worn motor."""

from typing import ClassVar

from torch import Tensor

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.quadrotor.common import rotor_reaction, rotor_thrust


class _RotorFault(WrenchEffect):
    """One rotor gives less thrust, and less reaction torque in proportion."""

    rotor: ClassVar[int]
    """Its number, from 1."""

    name = "rotor_fault"
    kind = "quadrotor"
    acts_on = "actuator"
    needs = ("rotor_speed",)
    source = "Freddi, Lanzon & Longhi 2011, A feedback linearization approach to fault tolerance in quadrotor vehicles"
    excitation = "hover, climb and yaw, since only a rotor fault follows the speed of a single rotor"
    symptom = "Steady roll, pitch and yaw torques appear together and grow with one rotor's speed."
    # Beside a spread of the other rotors, one weak rotor is as many weak ones.
    look_alikes = ("thrust_coefficient_error", "command_scale_error")

    @property
    def key(self) -> str:
        """Each rotor is an entry of its own."""
        return f"{self.name}@{self.rotor}"

    def subject(self, values: Values) -> str:
        """Return the number of the rotor."""
        return str(self.rotor)

    def wrench(self, signals: Signals, values: Values, constants: Values) -> dict[str, Tensor]:
        """Return the change from the lost thrust: specific force, m/s², and torque, N·m."""
        index = self.rotor - 1
        loss = values[f"loss_{self.rotor}"]
        thrust = loss * rotor_thrust(signals, constants)[..., index]
        x, y, _ = constants["rotor_positions"][index].to(thrust).unbind()
        return {
            "force_z": -thrust / constants["mass"],
            "torque_x": -y * thrust,
            "torque_y": x * thrust,
            "torque_z": -loss * rotor_reaction(signals, constants)[..., index],
        }


def _described(rotor: int) -> tuple[tuple[Parameter, ...], str, str]:
    """Return parameter, formula and sentence of one rotor's fault."""
    loss = f"loss_{rotor}"
    formula = f"T_{rotor} = (1 − {loss}) · k · Ω_{rotor}², and its reaction torque likewise"
    sentence = (
        f"Rotor {rotor} has lost a fraction {{{loss}}} of its thrust; look for a damaged propeller or motor, or "
        f"weaken rotor {rotor} in the simulator."
    )
    # Damage costs some percent at least. Rotors of one batch differ by less, and then a centre of mass is more likely.
    return (Parameter(loss, "1", 0.2, 0.0, 1.0, typical=True),), formula, sentence


class FirstRotorFault(_RotorFault):
    """Rotor 1 gives less thrust and reaction torque than it should."""

    rotor = 1
    parameters, formula, sentence = _described(1)


class SecondRotorFault(_RotorFault):
    """Rotor 2 gives less thrust and reaction torque than it should."""

    rotor = 2
    parameters, formula, sentence = _described(2)


class ThirdRotorFault(_RotorFault):
    """Rotor 3 gives less thrust and reaction torque than it should."""

    rotor = 3
    parameters, formula, sentence = _described(3)


class FourthRotorFault(_RotorFault):
    """Rotor 4 gives less thrust and reaction torque than it should."""

    rotor = 4
    parameters, formula, sentence = _described(4)
