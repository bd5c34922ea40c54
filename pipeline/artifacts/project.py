"""Where the project lies, whatever the working directory of the person who calls it."""

from pathlib import Path

PROJECT_ROOT = Path(__file__).resolve().parents[2]
