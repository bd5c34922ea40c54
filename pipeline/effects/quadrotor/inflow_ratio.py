"""Rotor thrust and torque from blade-element and momentum theory.

This is one model level above `axial_inflow` and `translational_lift`, and it replaces both. Climb costs thrust,
sideways flight gains thrust, and both saturate. The torque of a rotor is that of its profile drag, which is kept, and
that of its thrust against the inflow, so that C_Q = σ·C_d/8 + λ·C_T. What is of order (V/ΩR)² is left out.
"""

from simgap.effects.effect import Parameter, Signals, Values, WrenchEffect
from simgap.effects.quadrotor.common import hover_rotor_speed
from simgap.effects.scan import scan
from simgap.physics.induced_velocity import induced_velocity
from simgap.physics.rotors import hub_velocity, wrench
from simgap.physics.shapes import Channels


class InflowRatio(WrenchEffect):
    """Thrust and torque change with the inflow through each disc, from blade-element and momentum theory."""

    linear = False
    names_physics = False
    name = "inflow_ratio"
    kind = "quadrotor"
    acts_on = "force"
    parameters = (
        Parameter("sensitivity", "1", 1.5, 0.0, 10.0),
        Parameter("induced_velocity", "m/s", 6.0, 0.5, 40.0, neutral=5.0),
        Parameter("induced_share", "1", 0.6, 0.0, 1.0, optional=True),
    )
    needs = ("velocity", "body_rate", "rotor_speed")
    formula = (
        "T / (k·Ω²) = 1 − sensitivity · ((v_z + u) / u_0 − 1) and = u·√(v_xy² + (v_z + u)²) / u_0², solved for u, with "
        "u_0 = induced_velocity · Ω / Ω_hover; Q / (k_Q·Ω²) = 1 + induced_share·(T / (k·Ω²) · (v_z + u) / u_0 − 1)"
    )
    source = (
        "Leishman 2006, Principles of helicopter aerodynamics, §2.14 and chapter 3 (sensitivity = solidity·lift slope "
        "/ (8·inflow ratio), induced_share = λ·C_T / C_Q in hover); Kantue & Pedro, grey-box modelling of multirotors "
        "in aggressive manoeuvres"
    )
    sentence = (
        "The thrust follows the inflow, {induced_velocity} m/s in hover, with a sensitivity of {sensitivity}, and a"
        " share of {induced_share} of the torque drives it; solve for the inflow in the simulator."
    )
    excitation = "climb, descend and fly level at several speeds, and combine them"
    symptom = "Climbs lose thrust and level flight gains it, and both saturate at high speed."

    def starts(self) -> list[dict[str, float]]:
        """Start from a scan: without sensitivity the induced velocity gives no gradient."""
        return scan(sensitivity=(0.5, 2.0), induced_velocity=(2.0, 5.0, 12.0), induced_share=(0.5,))

    def wrench(self, signals: Signals, values: Values, constants: Values) -> Channels:
        """Return specific force along body z, m/s², and the torque of all discs, N·m."""
        speed = signals["rotor_speed"]
        positions = constants["rotor_positions"].to(speed)
        hub = hub_velocity(signals["velocity"], signals["body_rate"], positions)
        hover, sensitivity = hover_rotor_speed(constants), values["sensitivity"]
        still = values["induced_velocity"] * speed / hover
        crossing, climb = hub[..., :2].square().sum(-1), hub[..., 2]
        through = climb + induced_velocity(still, crossing, climb, sensitivity)
        pace = speed * hover / values["induced_velocity"]  # Ω² over the induced velocity in still air
        excess = (through - still) * pace
        added = -constants["thrust_coefficient"] * sensitivity * excess
        # Ω²·(T / (k·Ω²)·through / still − 1), without a division by a rotor that stands
        driven = (
            excess - sensitivity * (through - still) * through * (hover / values["induced_velocity"]) ** 2
        )
        directions = constants["rotor_directions"].to(speed)
        twist = constants["torque_coefficient"] * values["induced_share"] * directions * driven
        force, torque = wrench(added, twist, positions)
        return {
            "force_z": force[..., 2] / constants["mass"],
            "torque_x": torque[..., 0],
            "torque_y": torque[..., 1],
            "torque_z": torque[..., 2],
        }
