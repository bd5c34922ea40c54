"""The command that runs the whole pipeline of a branch."""

import argparse
import sys
from pathlib import Path
from typing import NoReturn

from simgap.artifacts import require_checkout
from simgap.errors import InputError
from simgap.extras import require
from simgap.runner.command import report_mistakes

PREFERRED = "nanodrone"
FALLBACK = "embedded"

_ORIGINS = {
    "cache": "real recordings, downloaded earlier",
    "SIMGAP_DATA": "real recordings from the folder that SIMGAP_DATA names",
    "download": "real recordings, downloaded now",
}


def reproduce(branch: str | None = None) -> None:
    """Run a branch of the pipeline; by default the best one whose recordings are available."""
    from simgap.runner.reproduction import list_metrics

    checkout = require_checkout()
    require("dvc")
    branch, reason = choose(branch)
    print(f"branch {branch}: {reason}", flush=True)
    artifacts = checkout / "artifacts" / branch
    _reproduce("diagnose", branch)
    print(
        f"the diagnosis: {write_first_page(artifacts, branch)}; later stages are added to one page",
        flush=True,
    )
    _reproduce("report", branch)
    list_metrics()
    for page in sorted((artifacts / "report").glob("*.html")):
        print(f"the page: {page}", flush=True)


def _reproduce(stage: str, branch: str) -> None:
    from simgap.runner.reproduction import reproduce_target

    if reproduce_target(f"{stage}@{branch}") != 0:
        raise InputError("did not finish", f"branch {branch}", "see the lines above")


def write_first_page(artifacts: Path, branch: str) -> Path:
    """Write the page of the diagnosis before policies are trained, so that it can be read meanwhile."""
    from simgap.report import ReportInputs, write_page

    page = artifacts / "diagnosis.html"
    clean, sysid, diagnosis = (artifacts / stage for stage in ("clean", "sysid", "diagnose"))
    simulator = f"artifacts/{branch}/diagnose/simulator"
    write_page(ReportInputs(diagnosis, clean, sysid, name=branch, simulator=simulator), page)
    return page


def choose(branch: str | None) -> tuple[str, str]:
    """Return the branch to reproduce, and why that one or where its recordings come from.

    Raises:
        InputError: when there is no such branch, or its recordings cannot be reached.
    """
    if branch is not None:
        return branch, origin(branch)
    try:
        return PREFERRED, origin(PREFERRED)
    except InputError as error:
        return FALLBACK, f"{origin(FALLBACK)} ({error})"


def origin(branch: str) -> str:
    """Say where the recordings of a branch come from; what has to be downloaded is downloaded now.

    Raises:
        InputError: when they cannot be reached.
    """
    from simgap.recordings.registry import fetch, locate
    from simgap.runner.compose import compose

    dataset = compose([f"branch={branch}"])["dataset"]
    if dataset["source"] != "published":
        return "a flight recorded from the project's own concealed plant"
    place = locate(dataset["name"], dataset["files"])
    if place is None:
        remedy = "connect to the network, or name the folder of recordings in SIMGAP_DATA"
        raise InputError("the recordings cannot be reached", branch, remedy)
    if place == "download":
        print(f"branch {branch}: downloading the recordings", flush=True)
        fetch(dataset["name"], dataset["files"])
    return _ORIGINS[place]


def main(argv: list[str] | None = None) -> NoReturn:
    """Run the command line and exit."""
    parser = argparse.ArgumentParser(prog="simgap reproduce", description=reproduce.__doc__)
    parser.add_argument("branch", nargs="?", help="a file of conf/branch")
    parser.add_argument("--debug", action="store_true", help="show tracebacks")
    arguments = parser.parse_args(argv)
    sys.exit(report_mistakes("reproduce", arguments.debug, lambda: reproduce(arguments.branch)))


if __name__ == "__main__":
    main()
