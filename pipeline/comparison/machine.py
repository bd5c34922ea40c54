"""The machine that ran a measurement."""

import os
import platform
from importlib import metadata
from pathlib import Path


def processor() -> str:
    """Return the number of usable cores and the name of the processor."""
    listed = Path("/proc/cpuinfo")
    lines = listed.read_text().splitlines() if listed.exists() else []
    names = (line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    return f"{_cores()} cores of {next(names, platform.processor() or platform.machine())}"


def machine() -> str:
    """Return processor and versions."""
    return f"{processor()}, Python {platform.python_version()}, PyTorch {metadata.version('torch')}"


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
