"""Tables and pictures of flown laps, in simulation and on the plant."""

from typing import TYPE_CHECKING

from simgap.runner import StageRun

if TYPE_CHECKING:
    from simgap.gates.track import Track
    from simgap.policies.racing.laps import Laps


def write_laps(laps: "Laps", track: "Track", name: str, period: float, run: StageRun) -> None:
    """Write all laps, the flight of the fastest machine and its picture; print a summary of the race.

    Args:
        laps: that were flown.
        track: its gates.
        name: of the track.
        period: between two states of a flight, s.
        run: of the stage.
    """
    from simgap.policies.racing.tables import flight_table, laps_table
    from simgap.report.race import animate_race, race_figure

    laps_table(laps).to_parquet(run.output / "laps.parquet", index=False)
    flight = flight_table(laps, period)
    flight.to_parquet(run.output / "flight.parquet", index=False)
    gates = track.corners.cpu().numpy()
    figure = race_figure(flight, gates)
    figure.savefig(run.output / "line.png", dpi=150)
    animate_race(flight, gates, run.output / "flight.gif")
    run.log_figure(figure, "line")
    run.say(_said(laps, name))


def _said(laps: "Laps", track: str) -> str:
    measures = laps.metrics()
    share = f"{measures['laps_completed']:.0%} of laps on {track or 'the track'}"
    return f"{share}, {measures['mean_lap']:.2f} s on average" if "mean_lap" in measures else share
