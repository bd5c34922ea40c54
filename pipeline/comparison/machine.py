"""The machine that ran a measurement."""

import os
import platform
import sys
from importlib import metadata
from pathlib import Path


def processor() -> str:
    """Return the number of usable cores and the name of the processor."""
    listed = Path("/proc/cpuinfo")
    lines = listed.read_text().splitlines() if listed.exists() else []
    names = (line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    return f"{_cores()} cores of {next(names, platform.processor() or platform.machine())}"


def machine() -> str:
    """Return processor, the GPU that PyTorch sees, if any, and versions."""
    parts = [processor(), *graphics(), f"Python {platform.python_version()}"]
    return ", ".join([*parts, f"PyTorch {metadata.version('torch')}"])


def graphics() -> list[str]:
    """Return the name of the GPU; nothing where there is none, or where PyTorch is not loaded and so uses none."""
    torch = sys.modules.get("torch")
    return [torch.cuda.get_device_name()] if torch and torch.cuda.is_available() else []


def _cores() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
