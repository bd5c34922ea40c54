"""Frames, axes and quaternions of a quadrotor that are not the contract's."""

from collections.abc import Mapping

import numpy as np

from simgap.consistency.attitude import matrices
from simgap.consistency.samples import Samples
from simgap.consistency.transformation import Transformation, taken

_COMMON, _USUAL, _RARE, _ODD = 0.06, 0.03, 0.01, 0.004
_FLIPPED = {"x": "x", "y": "-y", "z": "-z"}  # forward-right-down or north-east-down
_ATTITUDE = tuple(f"attitude_{part}" for part in "wxyz")
_CONVERT = "Convert {} to the frames of the contract."


def frame_faults(samples: Samples) -> list[Transformation]:
    """Return every transformation of a quadrotor's frames."""
    force = ["specific_force"] if samples.has("specific_force", "xyz") else []
    return [
        *_whole(["position", "velocity"], ["body_rate", *force]),
        *_attitude(),
        *_vector("velocity"),
        *_vector("position"),
        *_vector("body_rate"),
        *(_vector("specific_force") if force else []),
        *_world("position and velocity", ("position", "velocity"), _USUAL),
        *_world("velocity", ("velocity",), _RARE),
        *_world("position", ("position",), _RARE),
        _rotated("velocity", "body_frame", "in the frame of the body", _COMMON, to_world=True),
        _rotated("body_rate", "body_frame", "in the frame of the world", _RARE, to_world=False),
        *(_forces() if force else []),
    ]


def _flips(stems: list[str]) -> dict[str, str]:
    return {
        f"{stem}_{axis}": source[:-1] + f"{stem}_{source[-1]}"
        for stem in stems
        for axis, source in _FLIPPED.items()
    }


def _whole(world: list[str], body: list[str]) -> list[Transformation]:
    """Return the frames of several groups at once: everything, what belongs to the body, or all but one group."""
    attitude = {"attitude_y": "-attitude_y", "attitude_z": "-attitude_z"}
    words = "north-east-down and forward-right-down"
    sets: dict[str, tuple[dict[str, str], float]] = {
        "position, velocity, attitude and all of the body": (_flips([*world, *body]) | attitude, _COMMON),
        "attitude and all of the body": (_flips(body) | attitude, _USUAL),
        "all of the body": (_flips(body), _USUAL),
        "position, velocity and attitude": (_flips(world) | attitude, _USUAL),
        "attitude and body_rate": (_flips(["body_rate"]) | attitude, _USUAL),
        "position, velocity, attitude and body_rate": (_flips([*world, "body_rate"]) | attitude, _RARE),
    }
    return [taken("frame", name, sources, odds, words) for name, (sources, odds) in sets.items()]


def _attitude() -> list[Transformation]:
    w, x, y, z = _ATTITUDE
    last = {w: z, x: w, y: x, z: y}
    return [
        taken("quaternion_order", "attitude", last, _COMMON, "with w last"),
        taken("conjugate", "attitude", {x: f"-{x}", y: f"-{y}", z: f"-{z}"}, _COMMON, "from world to body"),
        taken(
            "frame", "attitude", {y: f"-{y}", z: f"-{z}"}, _COMMON, "north-east-down and forward-right-down"
        ),
        taken(
            "quaternion_order",
            "attitude",
            {w: z, x: f"-{w}", y: f"-{x}", z: f"-{y}"},
            _RARE,
            "with w last, inverted",
        ),
        taken(
            "quaternion_order", "attitude", {w: z, x: w, y: f"-{x}", z: f"-{y}"}, _RARE, "with w last, in NED"
        ),
    ]


def _vector(stem: str) -> list[Transformation]:
    """Return the signs and orders of the axes of a vector of the body or the world."""
    signs = [taken("sign", f"{stem}_{axis}", {f"{stem}_{axis}": f"-{stem}_{axis}"}, _RARE) for axis in "xyz"]
    inverted = {f"{stem}_{axis}": f"-{stem}_{axis}" for axis in "xyz"}
    orders = ("yxz", "xzy", "zyx", "yzx", "zxy")
    exchanged = [
        {f"{stem}_{axis}": f"{stem}_{source}" for axis, source in zip("xyz", order, strict=True)}
        for order in orders
    ]
    return [
        *signs,
        taken("sign", stem, inverted, _RARE),
        taken("frame", stem, _flips([stem]), _USUAL, "with y to the right and z down"),
        *(taken("axis_order", stem, sources, _ODD) for sources in exchanged),
    ]


def _world(name: str, stems: tuple[str, ...], odds: float) -> list[Transformation]:
    """Return the frames of the world that vectors may have, where the attitude has the contract's."""
    maps: Mapping[str, tuple[str, Mapping[str, str]]] = {
        "north-east-down": ("frame", _FLIPPED),
        "east-north-up beside north-east-down": ("frame", {"x": "y", "y": "x", "z": "-z"}),
        "turned by a quarter to the left": ("axis_order", {"x": "-y", "y": "x", "z": "z"}),
        "turned by a quarter to the right": ("axis_order", {"x": "y", "y": "-x", "z": "z"}),
    }
    return [
        taken(
            suspected,
            name,
            {
                f"{stem}_{axis}": source[:-1] + f"{stem}_{source[-1]}"
                for stem in stems
                for axis, source in axes.items()
            },
            odds if words == "north-east-down" else _ODD,
            words,
        )
        for words, (suspected, axes) in maps.items()
        if len(stems) > 1 or words != "north-east-down"
    ]


def _rotated(
    stem: str, suspected: str, words: str, odds: float, to_world: bool, gravity: float = 0.0
) -> Transformation:
    """Return the transformation in which a vector was logged in the other frame, perhaps without gravity."""
    columns = tuple(f"{stem}_{axis}" for axis in "xyz")

    def mend(samples: Samples) -> dict[str, np.ndarray]:
        matrix = matrices(samples.stack("attitude", "wxyz"))
        vectors = samples.stack(stem, "xyz") + np.array([0.0, 0.0, gravity])
        turned = np.einsum("nij,nj->ni" if to_world else "nji,nj->ni", matrix, vectors)
        return dict(zip(columns, turned.T, strict=True))

    other = "world" if to_world else "body"
    remedy = f"Turn {stem!r} into the frame of the {other} by the attitude" + (
        ", and add gravity." if gravity else "."
    )
    return Transformation(suspected, stem, columns, odds, mend, remedy, words, _ATTITUDE)


def _forces() -> list[Transformation]:
    columns = tuple(f"specific_force_{axis}" for axis in "xyz")

    def mend(samples: Samples) -> dict[str, np.ndarray]:
        upward = matrices(samples.stack("attitude", "wxyz"))[:, 2, :] * 9.81
        return dict(zip(columns, (samples.stack("specific_force", "xyz") + upward).T, strict=True))

    remedy = "Log what the accelerometer reads: add gravity to 'specific_force', turned into the frame of the body."
    return [
        Transformation("missing_gravity", "specific_force", columns, _COMMON, mend, remedy, needs=_ATTITUDE),
        _rotated("specific_force", "body_frame", "in the frame of the world", _USUAL, to_world=False),
        _rotated(
            "specific_force",
            "missing_gravity",
            "in the frame of the world, without gravity",
            _USUAL,
            False,
            9.81,
        ),
    ]
