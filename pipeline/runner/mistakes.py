"""Errors of Hydra and OmegaConf as one-line input errors."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from simgap.errors import InputError
from simgap.extras import missing_launcher
from simgap.runner.project import nearest


@contextmanager
def configuration_mistakes(where: str = "configuration") -> Iterator[None]:
    """Turn every complaint about a configuration into an `InputError`.

    Args:
        where: what to name as the place where the complaint does not name one.
    """
    import yaml
    from hydra.errors import HydraException, MissingConfigException
    from omegaconf.errors import OmegaConfBaseException

    try:
        yield
    except MissingConfigException as error:
        raise _missing_option(error) from error
    except (HydraException, OmegaConfBaseException) as error:
        raise _mistake(error, where) from error
    except yaml.YAMLError as error:
        raise InputError(f"not valid YAML: {error}", "configuration", "correct the file") from error


def _missing_option(error: Any) -> InputError:
    """Say which option of a group is not there, and which one is near."""
    group, _, option = (error.missing_cfg_file or "").rpartition("/")
    if group == "hydra/launcher" and (missing := missing_launcher(option)):
        return missing
    if not error.options:
        return InputError(_first_line(error), "configuration", "see the folder conf")
    return InputError(f"there is no {option!r}", group, nearest(option, error.options))


def _mistake(error: BaseException, where: str) -> InputError:
    """Say what is wrong under which key; Hydra wraps what OmegaConf found."""
    from omegaconf.errors import ConfigAttributeError, ConfigKeyError, OmegaConfBaseException

    cause = error if isinstance(error, OmegaConfBaseException) else error.__cause__
    if not isinstance(cause, OmegaConfBaseException):
        where = (getattr(error, "override", None) or where).lstrip("+")
        return InputError(_first_line(error), where, "see --help; quote a value with special characters")
    where = str(cause.full_key or where)
    if isinstance(cause, ConfigKeyError | ConfigAttributeError):
        parent, _, key = where.rpartition(".")
        return InputError(f"unknown key {key!r}", parent or where, nearest(key, _siblings(cause)))
    return InputError(_first_line(cause), where, "correct the value")


def _siblings(error: Any) -> list[str]:
    """Return the keys that exist where an unknown one was given."""
    node = error.parent_node
    return [str(key) for key in node] if node is not None else []


def _first_line(error: BaseException) -> str:
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    return re.sub(r"\s+", " ", lines[0]).rstrip(".") if lines else type(error).__name__
