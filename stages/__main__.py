"""The command `simgap`: one subcommand per file of this folder."""

import importlib
import sys
from typing import NoReturn

from simgap.runner.project import commands, described, file_of, nearest

ORDER = (
    "inspect",
    "import",
    "reproduce",
    "stages",
    "configure",
    "record",
    "clean",
    "sysid",
    "train",
    "build_sim",
    "diagnose",
    "train_policy",
    "deploy",
    "identify_residual",
    "finetune",
    "redeploy",
    "evaluate",
    "report",
    "profile",
    "train_detector",
    "prove",
    "calibrate",
    "results",
    "effects",
    "motors",
)

HELP = {"-h", "--help"}
COMPLETION = (
    "--completion",
    "--complete",
)  # what a shell reads once, and what it asks at every press of the key

USAGE = """\
simgap: find the physics that a robot simulator lacks, from recordings of the real robot

usage: simgap COMMAND [key=value ...]      simgap COMMAND --help      simgap --version
       simgap --completion bash|zsh|fish

{commands}

A recording of your own:
  simgap inspect PATH
  simgap diagnose [--config-dir DIR] platform=NAME recording=PATH [mapping=FILE] output=DIR
  simgap diagnose platform=FILE [joint=NAME] recording=PATH output=DIR     (YAML, URDF or MJCF)
"""


def main(argv: list[str] | None = None) -> NoReturn:
    """Run the command that the first argument names with the remaining arguments."""
    arguments = sys.argv[1:] if argv is None else argv
    known = commands()
    if not arguments or arguments[0] in HELP:
        print(_usage(known), end="")
        sys.exit(0)
    name = arguments[0]
    if name == "--version":
        from importlib.metadata import version

        print(f"simgap {version('simgap')}")
        sys.exit(0)
    if name in COMPLETION:
        _complete(name, arguments[1:])
    if name not in known:
        print(f"simgap: unknown command {name!r}; {nearest(name, known)}", file=sys.stderr)
        sys.exit(2)
    if HELP & set(arguments) and (description := described(name)):
        from simgap.runner.command import stage_parser

        stage_parser(name, *description).print_help()
        sys.exit(0)
    from simgap.runner import Stage
    from simgap.runner import command as command_line

    module = importlib.import_module(f"simgap.stages.{file_of(name)}")
    command = getattr(module, file_of(name))
    if isinstance(command, Stage):
        command_line.main(command, arguments[1:])
    sys.exit(module.main(arguments[1:]))


def _complete(flag: str, words: list[str]) -> NoReturn:
    from simgap.runner.command import report_mistakes
    from simgap.runner.shell_completion import candidates, script

    if flag == "--complete":
        print("\n".join(candidates(words)))
        sys.exit(0)
    sys.exit(report_mistakes("--completion", False, lambda: print(script(" ".join(words)), end="")))


def _usage(known: dict[str, str]) -> str:
    names = sorted(known, key=lambda name: (ORDER.index(name) if name in ORDER else len(ORDER), name))
    width = max(map(len, names))
    return USAGE.format(commands="\n".join(f"  {name:{width}}  {known[name]}" for name in names))


if __name__ == "__main__":
    main()
