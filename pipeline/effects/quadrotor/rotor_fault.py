"""A rotor that is damaged: chipped, bent, loose or on a worn motor."""

from typing import ClassVar

from torch import Tensor

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect


class _RotorFault(WrenchEffect):
    """One rotor gives less thrust, and less reaction torque in proportion."""

    rotor: ClassVar[int]
    """Its number, from 1."""

    name = "rotor_fault"
    kind = "quadrotor"
    acts_on = "actuator"
    needs = ("rotor_speed",)
    source = "Freddi, Lanzon & Longhi 2011, A feedback linearization approach to fault tolerance in quadrotor vehicles"
    excitation = (
        "hover, climb and turn: every other cause of a steady torque keeps no proportion to one rotor's speed"
    )

    @property
    def key(self) -> str:
        """Each rotor is an entry of its own."""
        return f"{self.name}@{self.rotor}"

    def wrench(self, signals: Signals, values: Values, constants: Values) -> dict[str, Tensor]:
        """Return what the rotor no longer gives: specific force, m/s², and torque, N·m."""
        index = self.rotor - 1
        lost = values[f"loss_{self.rotor}"] * signals["rotor_speed"][..., index].square()
        thrust = constants["thrust_coefficient"] * lost
        x, y, _ = constants["rotor_positions"][index].to(lost).unbind()
        direction = constants["rotor_directions"][index].to(lost)
        return {
            "force_z": -thrust / constants["mass"],
            "torque_x": -y * thrust,
            "torque_y": x * thrust,
            "torque_z": -direction * constants["torque_coefficient"] * lost,
        }


def _described(rotor: int) -> tuple[tuple[Parameter, ...], str, str]:
    """Return parameter, formula and sentence of one rotor's fault."""
    loss = f"loss_{rotor}"
    formula = f"T_{rotor} = (1 − {loss}) · k · Ω_{rotor}², and its reaction torque likewise"
    sentence = (
        f"Rotor {rotor} gives less than it should: {{{loss}}} of its thrust is missing (0 none, 1 all); look for a "
        f"damaged propeller or motor, or weaken rotor {rotor} in the simulator."
    )
    return (Parameter(loss, "1", 0.2, 0.0, 1.0),), formula, sentence


class FirstRotorFault(_RotorFault):
    """The first rotor gives less thrust."""

    rotor = 1
    parameters, formula, sentence = _described(1)


class SecondRotorFault(_RotorFault):
    """The second rotor gives less thrust."""

    rotor = 2
    parameters, formula, sentence = _described(2)


class ThirdRotorFault(_RotorFault):
    """The third rotor gives less thrust."""

    rotor = 3
    parameters, formula, sentence = _described(3)


class FourthRotorFault(_RotorFault):
    """The fourth rotor gives less thrust."""

    rotor = 4
    parameters, formula, sentence = _described(4)
