"""Completion in a shell: commands, flags, groups with their options, and keys, asked of the program itself."""

from itertools import pairwise
from pathlib import Path

from simgap.artifacts.project import CONFIGURATION
from simgap.errors import InputError
from simgap.runner.project import commands, described, nearest

SCRIPTS = Path(__file__).parent / "completions"
FLAGS = ("--help", "--version", "--completion")

_PRESETS = ("branch", "experiment")  # groups that change what stages read
_OF_BRANCHES = ("reproduce", "stages")


def script(shell: str) -> str:
    """Return the script that a shell has to read once.

    Raises:
        InputError: when there is none for this shell.
    """
    scripts = {path.suffix[1:]: path for path in SCRIPTS.glob("simgap.*")}
    if shell not in scripts:
        raise InputError("is no shell that is known here", repr(shell), nearest(shell, scripts))
    return scripts[shell].read_text(encoding="utf-8")


def candidates(words: list[str]) -> list[str]:
    """Return what the last word may become.

    Args:
        words: of the command line after the program; the last one is being typed, and may be empty.
    """
    *before, word = words or [""]
    if not before:
        found = [*commands(), *FLAGS] if word.startswith("-") else list(commands())
    elif before[0] == "--completion":
        found = sorted(path.suffix[1:] for path in SCRIPTS.glob("simgap.*"))
    elif description := described(before[0]):
        found = _of_stage(before[0], description, before[1:], word)
    elif before[0] in _OF_BRANCHES and len(before) == 1:
        found = sorted(path.stem for path in (CONFIGURATION / "branch").glob("*.yaml"))
    else:
        found = []
    return [entry for entry in found if entry.startswith(word)]


def _of_stage(name: str, description: tuple[str, list[str]], before: list[str], word: str) -> list[str]:
    from simgap.runner.command import stage_parser

    if word.startswith("-"):
        parser = stage_parser(name, *description)
        return [
            option for action in parser._actions for option in action.option_strings if option[:2] == "--"
        ]
    folder = next((after for flag, after in pairwise(before) if flag == "--config-dir"), None)
    overrides = [text for text in before if "=" in text and not text.startswith("-")]
    try:
        return _of_configuration(description[1], overrides, word, folder)
    except Exception:  # a line that is half typed may be wrong anywhere: then nothing is proposed
        return []


def _of_configuration(keys: list[str], overrides: list[str], word: str, folder: str | None) -> list[str]:
    """Return groups and their options, and keys, of what a stage reads, as Hydra proposes them."""
    from hydra.plugins.completion_plugin import DefaultCompletionPlugin
    from omegaconf import OmegaConf

    from simgap.runner.compose import ROOT_CONFIG, compose, open_hydra, root_keys

    plugin = DefaultCompletionPlugin(open_hydra(folder).config_loader)
    groups, exact = plugin._query_config_groups(word, ROOT_CONFIG, [])
    known, read = root_keys(), {*keys, *_PRESETS}
    # A group that the root file does not name, as `experiment`, is added with a plus.
    found = [
        _ended(entry)
        for entry in groups
        if _group(entry) in read and (_group(entry) in known) != entry.startswith("+")
    ]
    if exact or word.startswith("+"):
        return found
    values = compose(overrides, folder)
    config = OmegaConf.create({key: values[key] for key in keys if key in values})
    return sorted({*found, *plugin._get_matches(config, word)})


def _ended(entry: str) -> str:
    """Return a group with the sign that follows it: Hydra leaves it open where a group has options and groups."""
    return entry if "=" in entry or entry.endswith("/") else f"{entry}="


def _group(entry: str) -> str:
    return entry.lstrip("+").partition("=")[0].partition("/")[0]
