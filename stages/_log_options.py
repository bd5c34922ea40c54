"""What the commands on a log take: its path, the kind, a mapping, and the platform that a mapping may need."""

import argparse
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from simgap.errors import InputError

_KEYS = ("platform", "joint", "mapping")


@dataclass(frozen=True)
class LogOptions:
    """What is known of a log.

    Attributes:
        kind: quadrotor, swerve or joint; None where nobody said it.
        mapping: path of a mapping; None where there is none.
        platform: its keys; None where none is given.
        said: what was given of it, as a shell takes it: ["platform=arm.urdf", "joint=elbow"].
    """

    kind: str | None
    mapping: Path | None
    platform: dict[str, Any] | None
    said: tuple[str, ...] = ()


def add_log_options(parser: argparse.ArgumentParser) -> None:
    """Add the log and what may be said of it."""
    parser.add_argument("path", type=Path, metavar="LOG", help="a log of any format, or the folder of one")
    parser.add_argument(
        "--map", type=Path, metavar="FILE", help="a mapping, as simgap inspect proposes it; or mapping=FILE"
    )
    parser.add_argument(
        "--kind", choices=("quadrotor", "swerve", "joint"), help="of the machine; else it is guessed"
    )
    parser.add_argument(
        "given",
        nargs="*",
        metavar="KEY=VALUE",
        help="platform=FILE or NAME, whose kind and numbers a mapping may need; joint=NAME of a URDF or MJCF file",
    )


def log_options(given: argparse.Namespace) -> LogOptions:
    """Return what was said of a log.

    Raises:
        InputError: when something else is given, or the platform cannot be used.
    """
    pairs = dict(
        text.split("=", 1) for text in given.given if text.partition("=")[0] in _KEYS and "=" in text
    )
    if len(pairs) != len(given.given):
        raise InputError(
            "is not known here",
            " ".join(given.given),
            "give platform=FILE, joint=NAME of a robot file, or mapping=FILE",
        )
    platform = _platform(pairs)
    kind = given.kind or (platform["kind"] if platform is not None else None)
    mapping = given.map or (Path(pairs["mapping"]) if "mapping" in pairs else None)
    said = tuple(f"{key}={pairs[key]}" for key in ("platform", "joint") if key in pairs)
    return LogOptions(kind, mapping, platform, said)


def _platform(pairs: dict[str, str]) -> dict[str, Any] | None:
    if "platform" not in pairs:
        if "joint" in pairs:
            raise InputError(
                "names a joint of a robot file", f"joint={pairs['joint']}", "give platform=FILE, too"
            )
        return None
    from simgap.api.inputs import platform_config
    from simgap.platforms import plain_config

    return plain_config(platform_config(pairs["platform"], pairs.get("joint")))
