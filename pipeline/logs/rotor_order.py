"""Motors by their places: a flight controller counts them in its order, and a platform file in another one."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from simgap.logs.proposal import Proposal

_GROUPS = ("motor_command", "motor_speed")


def by_place(proposal: Proposal, platform: Mapping[str, Any] | None) -> Proposal:
    """Return a proposal whose motors are in the order of the platform's rotors, where the log says their places.

    Args:
        proposal: for a log, in its own order.
        platform: its keys; None where it is not known.
    """
    positions = (platform or {}).get("rotor_positions")
    if not proposal.places or positions is None or np.shape(positions) != (4, 3):
        return proposal
    wanted = [(int(x), int(y)) for x, y, _ in np.sign(positions)]
    if wanted == list(proposal.places):
        return proposal
    if sorted(wanted) != sorted(proposal.places):
        note = "The rotors of the platform file stand elsewhere than the log says: correct rotor_positions."
        return replace(proposal, notes=(*proposal.notes, note))
    order = [proposal.places.index(place) + 1 for place in wanted]
    columns = dict(proposal.columns)
    for group in _GROUPS:
        if f"{group}_1" in columns:
            columns |= {
                f"{group}_{mine}": proposal.columns[f"{group}_{theirs}"]
                for mine, theirs in enumerate(order, 1)
            }
    said = (
        "The motors are taken by their places: rotors 1 to 4 of the platform file are motors "
        f"{_listed(order)} of the log."
    )
    return replace(proposal, columns=columns, notes=(*proposal.notes, said))


def _listed(order: list[int]) -> str:
    return f"{', '.join(map(str, order[:-1]))} and {order[-1]}"
