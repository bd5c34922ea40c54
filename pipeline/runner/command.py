"""The command line of a stage: flags, help, one-line errors, exit codes."""

import argparse
import logging
import os
import signal
import sys
import threading
import traceback
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import fields
from typing import Any, NoReturn, TextIO

from simgap.errors import InputError
from simgap.extras import named_extras
from simgap.runner.wrapper import Stage, import_stage

MISTAKE = 2
INTERRUPTED = 130
SIGNALLED = 128  # and the number of the signal, as shells count


def main(stage: Stage[Any], argv: Sequence[str] | None = None) -> NoReturn:
    """Run a stage as a command with these arguments, by default those of the process, and exit."""
    sys.exit(run_command(_importable(stage), sys.argv[1:] if argv is None else argv))


def _importable(stage: Stage[Any]) -> Stage[Any]:
    """Return the same stage out of its module, which `python -m simgap.stages.NAME` calls `__main__`."""
    specification = getattr(sys.modules["__main__"], "__spec__", None)
    if stage.__module__ != "__main__" or specification is None:
        return stage
    return import_stage(specification.name, stage.name)


def run_command(stage: Stage[Any], argv: Sequence[str]) -> int:
    """Run a stage with command-line arguments and return the exit code: 2 for a user's mistake."""
    parser = stage_parser(
        stage.name, stage.__doc__ or "", [field.name for field in fields(stage.config_class)]
    )
    flags, unknown = parser.parse_known_args(argv)
    with _ended_in_order():
        return report_mistakes(stage.name, flags.debug, lambda: _run(stage, flags, unknown))


def report_mistakes(name: str, debug: bool, action: Callable[[], None]) -> int:
    """Run work; print a user's mistake as one line on standard error (a traceback with `debug`)."""
    try:
        with _plain_output(debug), named_extras():
            action()
        sys.stdout.flush()
    except BrokenPipeError:
        # Whoever reads, such as `head`, has seen enough: what Python still holds goes nowhere.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except (InputError, OSError) as error:
        # An error of the system without a file's name is not something a person can mend.
        if isinstance(error, OSError) and error.filename is None:
            raise
        if debug:
            traceback.print_exc()
        text = str(error) if isinstance(error, InputError) else f"{error.filename}: {error.strerror}"
        print(f"simgap {name}: {text}", file=sys.stderr, flush=True)
        return MISTAKE
    except KeyboardInterrupt:
        print(f"simgap {name}: interrupted", file=sys.stderr, flush=True)
        return INTERRUPTED
    return 0


def _run(stage: Stage[Any], flags: argparse.Namespace, unknown: list[str]) -> None:
    from simgap.runner.compose import compose, typed
    from simgap.runner.sweep import run_sweep

    overrides = [*flags.overrides, *unknown]
    for text in overrides:
        if text.startswith("-"):
            raise InputError("unknown flag", text, "see --help")
    if flags.multirun:
        run_sweep(stage, overrides, flags.config_dir)
        return
    values = compose(overrides, flags.config_dir)
    if flags.cfg:
        from omegaconf import OmegaConf

        print(OmegaConf.to_yaml(OmegaConf.structured(typed(stage.config_class, values))), end="")
        return
    _warn_unread(stage, overrides, values)
    output = stage.run(values)
    logging.getLogger("simgap").info("%s: wrote %s", stage.name, output)
    if (page := output / "report.html").exists():
        print(page)  # the last line: what a person opens next


def _warn_unread(stage: Stage[Any], overrides: Sequence[str], values: dict[str, Any]) -> None:
    """Warn that an override has no effect on this stage."""
    read = {field.name for field in fields(stage.config_class)}
    for override in overrides:
        first, dot, _ = override.partition("=")[0].lstrip("+~").partition(".")
        if (dot or not isinstance(values.get(first), dict)) and first in values and first not in read:
            print(
                f"warning: {stage.name} does not read {first!r}, so {override!r} has no effect",
                file=sys.stderr,
            )


@contextmanager
def _ended_in_order() -> Iterator[None]:
    """Make an exception of a request to end a stage: nothing is left half-written, and the run is closed."""

    def end(number: int, _: object) -> NoReturn:
        sys.exit(SIGNALLED + number)

    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGTERM, end)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


class _Lines(logging.StreamHandler[TextIO]):
    """Writes lines for as long as somebody reads them: a stage ends its work also after `| head`."""

    def handleError(self, record: logging.LogRecord) -> None:
        """Report an error, but not that the reader has gone."""
        if not isinstance(sys.exc_info()[1], BrokenPipeError):
            super().handleError(record)


@contextmanager
def _plain_output(debug: bool) -> Iterator[None]:
    """Log plain lines to standard output, and leave out what libraries want to tell their developers."""
    handler = _Lines(sys.stdout)
    handler.setFormatter(logging.Formatter("%(message)s"))
    root = logging.getLogger()
    level = root.level
    root.addHandler(handler)
    root.setLevel(logging.DEBUG if debug else logging.WARNING)
    logging.getLogger("simgap").setLevel(logging.DEBUG if debug else logging.INFO)
    try:
        with warnings.catch_warnings():
            if not debug:
                warnings.simplefilter("ignore")
            yield
    finally:
        root.removeHandler(handler)
        root.setLevel(level)


def stage_parser(name: str, text: str, keys: Sequence[str]) -> argparse.ArgumentParser:
    """Return the parser of a stage's flags, which also prints its help.

    Args:
        name: of the stage.
        text: what it does.
        keys: of the configuration that it reads.
    """
    parser = argparse.ArgumentParser(
        prog=f"simgap {name}",
        description=text,
        epilog=f"Keys that it reads: {', '.join(keys)}. Their values: --cfg.",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("overrides", nargs="*", metavar="key=value", help="change a value")
    parser.add_argument("-m", "--multirun", action="store_true", help="one job per combination of key=a,b,c")
    parser.add_argument("--config-dir", "-cd", metavar="DIR", help="your own groups: DIR/platform/NAME.yaml")
    parser.add_argument("--cfg", action="store_true", help="print the configuration and stop")
    parser.add_argument("--debug", action="store_true", help="show tracebacks and the messages of libraries")
    return parser
