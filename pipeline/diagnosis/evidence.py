"""The evidence of a diagnosis: tables and series that the report draws."""

import itertools
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import torch
from torch import Tensor

from simgap.diagnosis.contract import write_json
from simgap.diagnosis.diagnose import Diagnosis, regimes_on
from simgap.diagnosis.learned import LearnedResidual
from simgap.diagnosis.ranking import candidates, hypotheses
from simgap.diagnosis.regimes import Regime, bin_of, mean_per_bin, parted_at_zero, quantile_edges
from simgap.diagnosis.validate import gap_closed
from simgap.effects import Effect
from simgap.equations.residuals import channel_series, measured_rows, residual_rows
from simgap.physics.weak_form import mean_of
from simgap.simulation import Simulator
from simgap.simulation.blocks import Blocks

_BINS = 8
_LAW_BINS, _LAW_POINTS = 15, 60  # of what is left by the others, and of the law itself
_AS_WELL = 0.95  # of how well the best variable orders a law; then the one that is named first is drawn
_EMPTY, _NOTABLE = 0.5, 0.02  # of the way between two points of a law, and of its range: no line crosses more
_STEP = 0.25  # of a law's reach, within one step of its points across zero
_MOST_ROWS = 20_000
_Z95 = 1.96


def write_evidence(diagnosis: Diagnosis, folder: Path) -> None:
    """Write every table and series of a diagnosis into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    traces(diagnosis).to_parquet(folder / "traces.parquet", index=False)
    residuals(diagnosis).to_parquet(folder / "residuals.parquet", index=False)
    naming = diagnosis.naming
    write_json(
        {"probabilities": naming.posterior.inclusion(), "shares": dict(naming.shares)},
        folder / "posterior.json",
    )
    write_json(hypotheses(diagnosis), folder / "hypotheses.json")
    write_json(candidates(diagnosis), folder / "candidates.json")
    write_json(laws(diagnosis), folder / "laws.json")
    write_json(horizons(diagnosis), folder / "horizon.json")
    write_json(regime_maps(diagnosis), folder / "regimes.json")
    write_json(memories(diagnosis), folder / "memory.json")
    write_json(learned(diagnosis), folder / "learned.json")
    for entry in diagnosis.learned:
        samples(entry).to_parquet(folder / f"learned_{entry.channel.name}.parquet", index=False)
    write_json({m.channel.name: m.runs for m in diagnosis.mismatches}, folder / "runs.json")


def _rows(diagnosis: Diagnosis, blocks: Blocks, simulator: Simulator) -> tuple[Tensor, Tensor]:
    """Return measured and predicted rows, (blocks, rows, channels) each."""
    functions = diagnosis.fitting.functions
    measured, predicted = [], []
    for series in channel_series(simulator, blocks):
        measured.append(measured_rows(series, blocks, functions))
        predicted.append(mean_of(functions, series.predicted))
    return torch.stack(measured, dim=-1), torch.stack(predicted, dim=-1)


def _labels(blocks: Blocks, diagnosis: Diagnosis) -> dict[str, np.ndarray]:
    centres = diagnosis.fitting.functions.centres * blocks.time_step
    names = np.array(blocks.runs, dtype=object)[blocks.run.numpy()]
    return {
        "run": names.repeat(len(centres)),
        "t": (blocks.start[:, None] + centres).flatten().numpy(),
    }


def traces(diagnosis: Diagnosis) -> pd.DataFrame:
    """Return measured and simulated wrenches on the proving runs, one row per window."""
    blocks = diagnosis.proving
    measured, before = _rows(diagnosis, blocks, diagnosis.nominal)
    # The clocks that the named effects settle move the prediction, not what was measured.
    _, after = _rows(diagnosis, blocks, diagnosis.simulator)
    tables = []
    for i, channel in enumerate(diagnosis.channels):
        columns = {
            "measured": measured[..., i],
            "before": before[..., i],
            "after": after[..., i],
        }
        values = {name: value.flatten().numpy() for name, value in columns.items()}
        tables.append(
            pd.DataFrame(_labels(blocks, diagnosis) | values).assign(channel=channel.name, unit=channel.unit)
        )
    return pd.concat(tables, ignore_index=True)


def residuals(diagnosis: Diagnosis) -> pd.DataFrame:
    """Return residual rows before and after beside the regime variables, of fitted and proving runs."""
    parts = {"train": diagnosis.fitting.blocks, "holdout": diagnosis.proving}
    channels = diagnosis.channels
    functions = diagnosis.fitting.functions
    most = max(_MOST_ROWS // (len(parts) * len(channels) * len(functions.centres)), 1)
    tables = []
    for part, blocks in parts.items():
        blocks = blocks.thinned(most)
        before, after = (
            residual_rows(s, blocks, functions) for s in (diagnosis.nominal, diagnosis.simulator)
        )
        regimes = {
            regime.name: mean_of(functions, regime.series).flatten().numpy()
            for regime in regimes_on(blocks, diagnosis.simulator)
        }
        labels = _labels(blocks, diagnosis)
        for i, channel in enumerate(channels):
            values = {"before": before[..., i].flatten().numpy(), "after": after[..., i].flatten().numpy()}
            table = pd.DataFrame(labels | values | regimes)
            tables.append(table.assign(part=part, channel=channel.name, unit=channel.unit))
    return pd.concat(tables, ignore_index=True)


def memories(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """Return the correlations of the remaining residual with its own past and with past inputs."""
    return [asdict(memory) | {"channel": memory.channel.name} for memory in diagnosis.memories]


def learned(diagnosis: Diagnosis) -> dict[str, Any]:
    """Return the error with the learned residuals, in the metric of the fit, and their settings."""
    validation = diagnosis.validation
    closed = (
        None
        if validation.learned is None
        else gap_closed(validation.before, validation.learned, validation.noise_floor)
    )
    return {
        "after": validation.learned,
        "gap_closed": closed,
        "channels": [
            {
                "channel": entry.channel.name,
                "unit": entry.channel.unit,
                "features": list(entry.features),
                "neighbours": entry.neighbours.count,
                "samples": len(entry.neighbours.inputs),
                "explained": entry.explained,
            }
            for entry in diagnosis.learned
        ],
    }


def samples(entry: LearnedResidual) -> pd.DataFrame:
    """Return the windows of a learned residual: features in SI units, and the residual."""
    columns = {name: entry.neighbours.inputs[:, i].numpy() for i, name in enumerate(entry.features)}
    return pd.DataFrame(columns | {"residual": entry.neighbours.outputs[:, 0].numpy()})


def laws(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """Return, for each named effect and channel it acts on, its law drawn through what it explains."""
    blocks, fit = diagnosis.fitting.blocks, diagnosis.naming.fit
    functions = diagnosis.fitting.functions
    regimes = [(r, mean_of(functions, r.series).flatten()) for r in regimes_on(blocks, diagnosis.simulator)]
    cluster = diagnosis.fitting.cluster.repeat_interleave(len(functions.centres))
    drawn = []
    inside = {f.effect.key: f.effect for f in fit.simulator.free}
    for key in (named.effect.key for named in diagnosis.naming.named if named.effect.key in inside):
        kept = tuple(f for f in diagnosis.simulator.effects if f.effect.key != key)
        without = residual_rows(diagnosis.simulator.with_effects(kept), blocks, functions)
        contribution = without - fit.residual
        for i, channel in enumerate(diagnosis.channels):
            law = contribution[..., i].flatten()
            if float(law.abs().max()) > 0:
                target = law + fit.residual[..., i].flatten()
                drawn.append(
                    {"effect": key, "channel": channel.name, "unit": channel.unit}
                    | _law(law, target, _depends_on(inside[key], regimes), cluster)
                )
    return drawn


def _depends_on(effect: Effect, regimes: list[tuple[Regime, Tensor]]) -> list[tuple[Regime, Tensor]]:
    """Return the variables of the signals that an effect needs, in its order; all where it needs none of them."""
    needed = [entry for signal in effect.needs for entry in regimes if entry[0].of == signal]
    return needed if any(len(quantile_edges(values, 2)) > 2 for _, values in needed) else regimes


def _law(
    law: Tensor, target: Tensor, regimes: list[tuple[Regime, Tensor]], cluster: Tensor
) -> dict[str, Any]:
    """Bin what an effect explains over the variable that orders it best: no bin reaches across zero.

    The line of the law has a gap (a None) where the recording has one.
    """
    scored = []
    for regime, values in regimes:
        edges = parted_at_zero(quantile_edges(values, _LAW_BINS))
        if len(edges) < 3:
            continue
        place = bin_of(values, edges)
        means = mean_per_bin(law, place, len(edges) - 1)
        scored.append((float((means[place] - law.mean()).square().mean()), regime, values, edges))
    best = max(score for score, *_ in scored)
    _, regime, values, edges = next(entry for entry in scored if entry[0] >= _AS_WELL * best)
    place, count = bin_of(values, edges), len(edges) - 1
    mean = mean_per_bin(target, place, count)
    spread = mean_per_bin((target - mean[place]).square(), place, count)
    # Rows of one cluster move together: as many independent values as clusters in the bin.
    independent = torch.tensor(
        [len(torch.unique(cluster[place == b])) for b in range(count)], dtype=torch.float64
    )
    error = _Z95 * (spread / independent.clamp_min(1.0)).sqrt()
    x, line = _line(law, values)
    return {
        "variable": regime.name,
        "variable_unit": regime.unit,
        "x": x,
        "law": line,
        "bins": {
            "x": mean_per_bin(values, place, count).tolist(),
            "mean": mean.tolist(),
            "low": (mean - error).tolist(),
            "high": (mean + error).tolist(),
        },
    }


def _line(law: Tensor, values: Tensor) -> tuple[list[float], list[float | None]]:
    """Return a law over a variable as a line: a step at zero upright, a None where nothing was recorded between."""
    edges = parted_at_zero(quantile_edges(values, _LAW_POINTS))
    place, count = bin_of(values, edges), len(edges) - 1
    filled = torch.bincount(place, minlength=count) > 0
    x, y = (mean_per_bin(series, place, count)[filled].tolist() for series in (values, law))
    known = values.sort().values
    reach = max(y) - min(y)
    points: list[tuple[float, float | None]] = [(x[0], y[0])]
    for (left, right), (low, high) in zip(itertools.pairwise(x), itertools.pairwise(y), strict=True):
        first = max(int(torch.searchsorted(known, left)) - 1, 0)
        inside = known[first : int(torch.searchsorted(known, right)) + 1]
        empty = float(inside.diff().max())
        if empty > _EMPTY * (right - left) and empty > _NOTABLE * (x[-1] - x[0]):
            points.append(((left + right) / 2, None))
        elif left < 0 < right and abs(high - low) > _STEP * reach:
            points += [(0.0, low), (0.0, high)]
        points.append((right, high))
    return [place for place, _ in points], [height for _, height in points]


def horizons(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """Return the errors of open-loop predictions over their length."""
    return [
        {
            "quantity": error.quantity,
            "unit": error.unit,
            "horizon": error.horizon.tolist(),
            "before": error.before[:, 0].tolist(),
            "before_low": error.before[:, 1].tolist(),
            "before_high": error.before[:, 2].tolist(),
            "after": error.after[:, 0].tolist(),
            "after_low": error.after[:, 1].tolist(),
            "after_high": error.after[:, 2].tolist(),
            "noise_floor": error.noise_floor.tolist(),
        }
        for error in diagnosis.horizons
    ]


def regime_maps(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """Return the RMS residual per channel and bin of every regime variable, on the proving runs."""
    blocks, functions = diagnosis.proving, diagnosis.fitting.functions
    before, after = (residual_rows(s, blocks, functions) for s in (diagnosis.nominal, diagnosis.simulator))
    maps = []
    for regime in regimes_on(blocks, diagnosis.simulator):
        values = mean_of(functions, regime.series).flatten()
        edges = quantile_edges(values, _BINS)
        if len(edges) < 3:
            continue
        place, count = bin_of(values, edges), len(edges) - 1
        for i, channel in enumerate(diagnosis.channels):
            rms = [
                mean_per_bin(rows[..., i].flatten().square(), place, count).sqrt().tolist()
                for rows in (before, after)
            ]
            maps.append(
                {
                    "channel": channel.name,
                    "channel_unit": channel.unit,
                    "variable": regime.name,
                    "unit": regime.unit,
                    "edges": edges.tolist(),
                    "before": rms[0],
                    "after": rms[1],
                    "noise_floor": float(diagnosis.validation.channels[i, 2]),
                }
            )
    return maps
