"""The stage that fits the recalibration of the probabilities to benchmarks on calibration seeds."""

import json
from dataclasses import dataclass, field

from simgap.benchmark.settings import Benchmark
from simgap.runner import StageConfig, StageRun, stage


@dataclass
class CalibrateStage(StageConfig):
    """The configuration of calibration."""

    prove: Benchmark = field(default_factory=Benchmark)


@stage(CalibrateStage)
def calibrate(config: CalibrateStage, run: StageRun) -> None:
    """Fit the recalibration of the probabilities to benchmark results on calibration seeds."""
    import yaml

    from simgap.artifacts import require_checkout
    from simgap.benchmark.calibration import fit_calibration, statements_of
    from simgap.errors import InputError
    from simgap.gap.calibration import CALIBRATION, hash_of_score

    if config.prove.write_calibration:
        require_checkout("prove.write_calibration=true")
    if not config.prove.results:
        raise InputError("no results are given", "prove.results", "give [FILE, ...] of simgap prove")
    results = [
        result
        for path in config.prove.results
        for result in json.loads(run.input(path).read_text(encoding="utf-8"))
        if "case" in result
    ]
    code = hash_of_score()
    content = {
        "made_by": f"simgap calibrate on {len(results)} cases",
        "seeds": sorted({result["seed"] for result in results}),
        "kinds": sorted({result["case"]["kind"] for result in results}),
        "code": code,
        **fit_calibration(statements_of(results, code)),
    }
    text = yaml.safe_dump(content, sort_keys=False, allow_unicode=True)
    (run.output / CALIBRATION.name).write_text(text, encoding="utf-8")
    if config.prove.write_calibration:
        CALIBRATION.write_text(text, encoding="utf-8")
    print(text, end="")


if __name__ == "__main__":
    from simgap.runner.command import main

    main(calibrate)
