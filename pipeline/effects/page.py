"""The catalogue as a page of the documentation, in Markdown."""

import re
from collections.abc import Iterable, Sequence

from simgap.effects.catalogue import effects_of, kinds, look_alikes_of
from simgap.effects.effect import Effect
from simgap.effects.listing import facts, meaning

_HEAD = """\
# Effects

This catalogue lists the physics that a simulator may lack and that a diagnosis looks for. The command
`simgap effects --write docs/effects.md` generates this page from the code. `simgap effects KIND NAME` prints one entry.

Each kind of platform starts with a table of its effects. An entry for each effect follows:

- **Acts on** is the place on the way from command to measurement. Names that end in `_error` correct a number of the
  platform file instead. In a swerve drive the place is a group: `drive`, `steer` or `chassis`.
- **Law** is the formula that the simulator adds and that the diagnosis fits.
- **In a log** is what you can see in a plot of the recording.
- **Manoeuvre** is the motion that shows the effect and separates it from its look-alikes.
- **Look-alikes** are effects that explain the same data if the recording lacks this motion.
- **Needs** lists the signals that the effect requires.
- **Diagnosis** is the statement in a diagnosis, filled with the default values.

Each parameter has a realistic default and bounds. Where one value of it alone stops the effect, it is given, too.
On a sliding joint read N for N·m and m for rad.

The fit of a joint does not depend on its size. It multiplies default and bounds by the typical effort, travel, speed
and current of the recording, each to the power with which it enters the parameter's unit: read 0.1 N·m as a tenth of
the typical effort. Defaults of a quadrotor are those of the racer of `conf/platform/racer.yaml`, and of a swerve drive
those of `conf/platform/swerve_robot.yaml`. Lengths grow with the arms or wheels of the platform, torques with its
weight at their end, and the inertia of rotors with that torque over their speed in hover.
"""


def catalogue_page() -> str:
    """Return the page: for each kind a table of its effects, then an entry for each effect."""
    return "\n".join([_HEAD, *(_kind(kind) for kind in kinds())])


def _kind(kind: str) -> str:
    effects = effects_of(kind)
    rows = [(_link(effect), effect.acts_on, meaning(effect)) for effect in effects]
    table = _table(("effect", "acts on", "meaning"), rows)
    return "\n".join([f"## {kind}\n", table, *(_section(effect) for effect in effects)])


def _section(effect: Effect) -> str:
    numbers = [
        (f"`{p.name}`", p.unit, *(f"{value:g}" for value in (p.default, p.low, p.high, p.neutral)))
        for p in effect.parameters
    ]
    table = _table(("parameter", "unit", "default", "from", "to", "neutral"), numbers)
    listed = [f"- **{name}:** {_shown(effect, name, text)}" for name, text in facts(effect)]
    head = [f"### {_title(effect)}\n", f"{meaning(effect)} Acts on: {effect.acts_on}.\n"]
    return "\n".join([*head, *listed, "", table])


def _shown(effect: Effect, name: str, text: str) -> str:
    """Return a fact as the page shows it: the law as code, look-alikes as links."""
    if name == "Look-alikes":
        return ", ".join(map(_link, look_alikes_of(effect))) or text
    return f"`{text}`" if name == "Law" else text


def _link(effect: Effect) -> str:
    return f"[`{effect.key}`](#{_anchor(effect)})"


def _title(effect: Effect) -> str:
    return f"{effect.kind} {effect.key}"


def _anchor(effect: Effect) -> str:
    """Return the anchor that GitHub and MkDocs give to the title of a section."""
    return re.sub(r"[^\w -]", "", _title(effect)).replace(" ", "-")


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines) + "\n"
