"""Imagined diagnoses by docs/contract.md: every verdict, nulls, empty lists, and any text wherever text goes."""

from typing import Any

VERDICTS = ("missing_physics", "parameter_mismatch", "none", "unexplained", "contradiction")
RUNS = ("melon_run1", "melon_run4", "melon_run5")

_EFFECTS: dict[str, list[dict[str, Any]]] = {
    "missing_physics": [
        {
            "name": "rotor_drag",
            "probability": 0.998,
            "acts_on": "force",
            "parameters": {"coefficient": {"value": 0.4512, "std": 0.0083, "unit": "1/s"}},
            "statement": "Air pushes back on the spinning rotors with 0.45 m/s² for every m/s of sideways "
            "airspeed: add this drag, or expect the simulated vehicle to coast too far.",
        },
        {
            "name": "axial_inflow",
            "probability": 0.94,
            "acts_on": "force",
            "parameters": {
                "thrust_slope": {"value": 2.04e-6, "std": 1.1e-7, "unit": "N/(rad/s)/(m/s)"},
                "offset": {"value": -0.08, "std": 0.02, "unit": "m/s^2"},
            },
            "statement": "Thrust falls while climbing.",
        },
    ],
    "parameter_mismatch": [
        {
            "name": "mass_error",
            "probability": 0.97,
            "acts_on": "force",
            "parameters": {"ratio": {"value": 1.123, "std": 0.004, "unit": "1"}},
            "statement": "The vehicle weighs 12 % more than the platform file says: weigh it.",
        }
    ],
    "none": [],
    "unexplained": [],
    "contradiction": [],
}
DOUBTED = {
    "name": "blade_flapping_moment",
    "probability": 0.31,
    "acts_on": "torque",
    "parameters": {"coefficient": {"value": -0.0123, "std": 0.004, "unit": "N*m/(m/s)"}},
    "statement": "Flapping blades pitch the vehicle up by -0.012 N·m for every m/s of airspeed.",
}

UNFINISHED = "the search was ended before it was complete; this is the best answer so far (gap.budget=120 s)"


def diagnosis(verdict: str, *, bare: bool = False, text: str = "") -> dict[str, Any]:
    """Return a diagnosis by docs/contract.md."""
    effects = [effect | ({"statement": text, "name": text} if text else {}) for effect in _EFFECTS[verdict]]
    fit: dict[str, Any] = {
        "metric": text or "RMS of the specific force over one step, m/s²",
        "held_out_runs": [] if bare else [text or RUNS[0], *RUNS[1:]],
        "before": None if bare else 0.184,
        "after": None if bare else (0.031 if effects else 0.184),
        "noise_floor": None if bare else (0.18 if verdict == "none" else 0.027),
        "gap_closed": None if bare or verdict == "none" else (0.974 if effects else 0.0),
        "gap_closed_interval": None
        if bare or verdict == "none"
        else [0.0, 0.03]
        if not effects
        else [0.95, 0.98],
    }
    mismatch = [
        (
            "force_x",
            0.61,
            "airspeed",
            1.2,
            3.2,
            1e-19,
            "Along x, almost only when flying faster than 1.2 m/s.",
        ),
        ("force_y", 0.27, "airspeed", 1.2, 3.2, 3e-7, "Along y, in the same regime, about half as strongly."),
        ("torque_y", 0.12, "body_rate", 2.0, 6.5, 0.0041, "In pitch, when turning fast."),
    ]
    return {
        "schema": "simgap.diagnosis/1",
        "verdict": verdict,
        "contradictions": _contradictions(text) if verdict == "contradiction" else [],
        "warnings": ["one run only: nothing could be held out"] if bare else _warnings(text),
        "mismatch": [] if bare or verdict == "none" else [_mismatch(*entry, text) for entry in mismatch],
        "effects": [] if bare else effects,
        "ambiguous": _ambiguous(text) if verdict == "missing_physics" and not bare else [],
        "unnamed": _unnamed(text) if verdict in ("missing_physics", "unexplained") and not bare else [],
        "fit": fit,
    }


def _contradictions(text: str) -> list[dict]:
    entry = {
        "column": "voltage",
        "runs": list(RUNS),
        "suspected": "sign",
        "evidence": "torque: the machine moves against what is commanded (correlation -0.99)",
        "remedy": "Compare the sign of 'voltage' with the platform file.",
    }
    return [entry | (dict.fromkeys(("column", "suspected", "evidence", "remedy"), text) if text else {})]


def _mismatch(
    channel: str, share: float, variable: str, low: float, high: float, p: float, where: str, text: str
) -> dict:
    regime = {"variable": text or variable, "low": low, "high": high}
    return {
        "channel": text or channel,
        "share": share,
        "regime": regime,
        "p_value": p,
        "where": text or where,
    }


def _warnings(text: str) -> list[str]:
    return [
        text or "run random1_run1: motor_speed_2 is frozen for 0.31 s",
        "the clock offset differs between runs",
    ]


def _ambiguous(text: str) -> list[dict]:
    remedy = "fly the same line in both directions: drag turns with the direction of flight, wind does not"
    return [{"names": [text or "body_drag", "steady_wind"], "separate_by": text or remedy}]


def _unnamed(text: str) -> list[dict]:
    formula = (
        "-0.031·velocity_x·motor_speed_mean + 0.0042·velocity_x²·body_rate_y − 0.11·sin(2·attitude_pitch)"
    )
    entry = {
        "channel": "torque_y",
        "depends_on": ["velocity_x", "motor_speed"],
        "formula": formula,
        "share": 0.12,
        "size": {"value": 0.21, "noise": 0.05, "unit": "N·m"},
    }
    return [entry | ({"channel": text, "depends_on": [text], "formula": text} if text else {})]
