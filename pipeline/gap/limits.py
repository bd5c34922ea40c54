"""Numbers of a platform that are wrong by more than a fit looks for."""

import math

from simgap.effects import ParameterError, effect_by_key
from simgap.gap.gains import IdentifiedGain, gain_remarks
from simgap.gap.prepare import Prepared
from simgap.platforms import Joint
from simgap.platforms.joint import GAINS
from simgap.recordings.contradiction import Contradiction
from simgap.simulation import Simulator

_NOTHING = 1e-12  # (m/s²)², where no rotor turns
_ON_LIMIT = 1e-3  # of a ratio, by which a fit may stay off its limit
_TO_TELL_GAINS = (
    "gains and friction look alike in a log of positions; give it in the platform file, or record the effort or the "
    "current beside command steps of several sizes"
)


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


def gains_said(simulator: Simulator, nominal: Simulator, on_limit: list[str]) -> list[str]:
    """Return a sentence about each gain that was identified; no value is given of one that the recording does not tell.

    Args:
        simulator: with the gains as they were found.
        nominal: with the first estimates.
        on_limit: what `at_limits` said, of gains also; they are left out here.
    """
    known = [remark for remark in gain_remarks(simulator, nominal) if not _is_about(remark, on_limit)]
    return [_untold(simulator, remark) or remark for remark in known]


def _is_about(remark: str, others: list[str]) -> bool:
    return any(other.partition(":")[0] == remark.partition(" ")[0] for other in others)


def _untold(simulator: Simulator, remark: str) -> str:
    """Return what is said in place of a remark on a gain whose error is as large as itself; empty where it is not."""
    controller = simulator.platform.controller if isinstance(simulator.platform, Joint) else None
    for gain in GAINS:
        value, std = (getattr(controller, name, None) for name in (gain, f"{gain}_std"))
        if (
            remark.startswith(f"controller.{gain} ")
            and value is not None
            and std is not None
            and std >= value
        ):
            return f"controller.{gain} was not given, and this recording does not tell it: {_TO_TELL_GAINS}"
    return ""


def _said(effect: ParameterError, ratio: float) -> str:
    if isinstance(effect, IdentifiedGain):
        return (
            f"controller.{effect.gain}: {ratio:.3g} times the first estimate is the limit of what is looked for, so "
            f"this recording does not tell the gain: {_TO_TELL_GAINS}"
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
