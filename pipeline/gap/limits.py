"""Numbers of a platform that are wrong by more than a fit looks for."""

import math

from simgap.effects import ParameterError, effect_by_key
from simgap.gap.gains import IdentifiedGain
from simgap.gap.prepare import Prepared
from simgap.recordings.contradiction import Contradiction
from simgap.simulation import Simulator

_NOTHING = 1e-12  # (m/s²)², where no rotor turns
_ON_LIMIT = 1e-3  # of a ratio, by which a fit may stay off its limit


def at_limits(simulator: Simulator) -> list[str]:
    """Return a sentence about each fitted ratio of a platform number that rests on a limit of the search."""
    found = []
    for fitted in simulator.free:
        if not isinstance(fitted.effect, ParameterError):
            continue
        ratio = fitted.effect.parameters[0]
        value = float(fitted.values[ratio.name])
        if min(abs(math.log(value / limit)) for limit in (ratio.low, ratio.high)) < _ON_LIMIT:
            found.append(_said(fitted.effect, value))
    return found


def _said(effect: ParameterError, ratio: float) -> str:
    if isinstance(effect, IdentifiedGain):
        return (
            f"controller.{effect.gain}: {ratio:.3g} times the first estimate is the limit of what is looked for, so "
            "this recording does not tell the gain; give it in the platform file, or record the effort"
        )
    return (
        f"{effect.name}: a ratio of {ratio:.3g} is the limit of what is looked for, so that the true one may lie "
        "beyond; multiply the number in the platform file by it, and run again"
    )


def excessive_thrust(prepared: Prepared) -> list[Contradiction]:
    """Return a contradiction where an accelerometer shows a thrust that no ratio within the limits accounts for.

    Without velocity and attitude nothing else tells it: a search would call it four faulty rotors.

    Args:
        prepared: of a quadrotor that recorded neither.
    """
    blocks, nominal = prepared.problem.blocks, prepared.nominal
    if "velocity" in blocks.signals or not {"body_rate", "specific_force"} <= blocks.signals.keys():
        return []
    signals = nominal.along_time(blocks.signals, blocks.time_step)
    given = blocks.inner(nominal.wrench(signals, nominal.constants())["force_z"])
    read = blocks.inner(blocks.signals["specific_force"])[..., 2]
    ratio = float((given * read).sum() / given.square().sum().clamp_min(_NOTHING))
    limits = effect_by_key("quadrotor", "thrust_coefficient_error").parameters[0]
    if limits.low < ratio < limits.high:
        return []
    evidence = f"force_z: the accelerometer reads {ratio:.2g} times the thrust that the platform file gives"
    remedy = f"Multiply thrust_coefficient by {ratio:.2g}, or correct mass, motor_speed_max or the unit."
    return [Contradiction("specific_force_z", "unit", evidence, remedy, tuple(map(str, blocks.runs)))]
