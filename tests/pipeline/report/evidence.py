"""Imagined evidence behind a diagnosis, seeded."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from tests.pipeline.report.diagnoses import RUNS

CHANNELS = {"force_x": "m/s²", "force_y": "m/s²", "force_z": "m/s²", "torque_y": "rad/s²"}


def write_json(path: Path, content: Any) -> None:
    """Write a JSON file."""
    path.write_text(json.dumps(content))


def write_evidence(folder: Path, verdict: str, text: str, random: np.random.Generator) -> None:
    """Write the evidence behind an imagined diagnosis."""
    runs = [text or RUNS[0], *RUNS[1:]]
    _traces(runs, text, random).to_parquet(folder / "traces.parquet")
    _residuals(runs, text, random).to_parquet(folder / "residuals.parquet")
    write_json(folder / "hypotheses.json", _hypotheses(verdict, text))
    write_json(folder / "candidates.json", _candidates(verdict, text))
    write_json(
        folder / "laws.json",
        [_law("force_x", text), _law("force_y", text)] if verdict == "missing_physics" else [],
    )
    write_json(folder / "horizon.json", [_horizon("position", "m", 0.13), _horizon("velocity", "m/s", 0.57)])
    write_json(folder / "regimes.json", _regimes(text, random))


def _traces(runs: list[str], text: str, random: np.random.Generator) -> pd.DataFrame:
    tables = []
    for number, run in enumerate(runs):
        time = 12.5 + np.concatenate([np.arange(0, 22, 0.01), np.arange(25, 40, 0.01)])
        for index, (channel, unit) in enumerate(CHANNELS.items()):
            truth = np.sin(time * (0.6 + 0.3 * index) + number) * (2.0 + np.sin(0.21 * time))
            columns = {"t": time, "measured": truth + 0.1 * random.normal(size=time.size)}
            columns |= {"before": 0.55 * truth, "after": 0.97 * truth}
            names = (
                {"run": run, "channel": text or channel, "unit": unit}
                if index == 0
                else {"run": run, "channel": channel, "unit": unit}
            )
            tables.append(pd.DataFrame(names | columns))
    return pd.concat(tables, ignore_index=True)


def _residuals(runs: list[str], text: str, random: np.random.Generator) -> pd.DataFrame:
    tables = []
    for channel, unit in CHANNELS.items():
        airspeed = random.uniform(-3.2, 3.2, 2500)
        before = -0.45 * airspeed + 0.15 * random.normal(size=airspeed.size)
        columns = {"t": np.arange(airspeed.size) * 0.05, "before": before, "after": before + 0.45 * airspeed}
        columns |= {"velocity_x": airspeed, "height": random.uniform(0, 2, airspeed.size)}
        part = np.where(np.arange(airspeed.size) % 3 == 0, "holdout", "train")
        tables.append(
            pd.DataFrame({"run": runs[0], "part": part, "channel": channel, "unit": unit} | columns)
        )
    return pd.concat(tables, ignore_index=True)


def _hypotheses(verdict: str, text: str) -> list[dict[str, Any]]:
    """Return three hypotheses: the best one, one with held commands and an estimated voltage, and that of no effect."""
    best = {"missing_physics": ["axial_inflow", "rotor_drag"], "parameter_mismatch": ["mass_error"]}
    named = [text] if text else best.get(verdict, [])
    entries = [
        (named, ["command_delay"], False, None, None, 0.84, 500.0, -30.0, -6.0),
        (named, [], True, text or "battery_voltage", None, 0.1, 496.0, -27.5, -6.7),
        ([], [], False, None, {"rotor_fault@3": ["b"]}, 1e-60, 349.0, -12.0, -2.0),
    ]
    keys = ("effects", "unnamed", "held", "estimated", "runs", "probability", "likelihood", "occam", "prior")
    return [dict(zip(keys, entry, strict=True)) | {"score": sum(entry[-3:])} for entry in entries]


def _candidates(verdict: str, text: str) -> list[dict[str, Any]]:
    drag = {"coefficient": {"value": 0.4512, "std": 0.0083, "unit": "1/s"}}
    entries = [
        ("rotor_drag", "in", 0.998, drag, "explains 91% of the error in force_x beside the other effects"),
        (
            "blade_flapping_moment",
            "in",
            0.31,
            drag,
            "explains 12% of the error in torque_y beside the other effects",
        ),
        ("body_drag", "rival", 0.4, drag, "could stand in for rotor_drag"),
        (
            "rotor_fault@3",
            "out",
            0.04,
            {},
            "the best answer with it explains less: 3.2 less of log probability",
        ),
        (
            "motor_lag",
            "out",
            0.02,
            {},
            "the best answer with it needs more parameters than it earns: 3.9 less of log probability",
        ),
    ]
    keys = ("name", "status", "probability", "parameters", "why")
    shown = entries if verdict == "missing_physics" else entries[3:]
    hostile = {"name": text, "why": text} if text else {}
    return [dict(zip(keys, entry, strict=True)) | hostile for entry in shown]


def _law(channel: str, text: str) -> dict[str, Any]:
    x = np.linspace(-3.2, 3.2, 60)
    at = np.linspace(-2.8, 2.8, 9)
    bins = {"x": at, "mean": -0.45 * at, "low": -0.45 * at - 0.06, "high": -0.45 * at + 0.06}
    entry = {
        "effect": text or "rotor_drag",
        "channel": channel,
        "variable": "velocity_x",
        "variable_unit": "m/s",
    }
    curve = {"unit": "m/s²", "x": x.tolist(), "law": (-0.45 * x).tolist()}
    return entry | curve | {"bins": {key: value.tolist() for key, value in bins.items()}}


def _horizon(quantity: str, unit: str, final: float) -> dict[str, Any]:
    time = np.array([0.01, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5])
    before, after = final * (time / 0.5) ** 1.6, 0.22 * final * (time / 0.5) ** 1.6
    curves = {"before": before, "before_low": before * 0.85, "before_high": before * 1.2}
    curves |= {"after": after, "after_low": after * 0.8, "after_high": after * 1.25}
    curves |= {"horizon": time, "noise_floor": np.full(time.size, 0.015 * final)}
    return {"quantity": quantity, "unit": unit} | {key: value.tolist() for key, value in curves.items()}


def _regimes(text: str, random: np.random.Generator) -> list[dict[str, Any]]:
    variables = {
        "airspeed": ("m/s", [0, 0.4, 0.8, 1.2, 1.7, 2.3, 3.2]),
        "turning_rate": ("rad/s", [0, 0.5, 1.1, 2.4, 6.5]),
        "velocity_z": ("m/s", [-1.1, -0.3, 0.0, 0.3, 1.2]),
        "battery_voltage": ("V", [3.1, 3.4, 3.6, 3.8, 4.1]),
        "height": ("m", [0.1, 0.5, 0.9, 1.2, 1.5, 2.1]),
    }
    entries = []
    for variable, (unit, edges) in variables.items():
        for index, (channel, channel_unit) in enumerate(CHANNELS.items()):
            slope = np.linspace(1, 8 if variable == "airspeed" and index < 2 else 2, len(edges) - 1)
            before = 0.03 * slope * random.uniform(0.9, 1.1, slope.size)
            named = text if text and index == 0 else channel
            known = {
                "channel": named,
                "channel_unit": channel_unit,
                "variable": variable,
                "unit": unit,
                "edges": edges,
            }
            entries.append(
                known
                | {"before": before.tolist(), "after": (0.03 + 0.1 * before).tolist(), "noise_floor": 0.03}
            )
    return entries
