"""Lay the package out by links as an installation has it, for checkers that read files and follow no import hooks.

python -m tools.link_package build/package
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]


def link_package(folder: Path) -> None:
    """Fill a folder with `simgap`: a link for each part of `pipeline/`, and for `stages/` and `conf/`."""
    package = folder / "simgap"
    package.mkdir(parents=True, exist_ok=True)
    wanted = {path.name: path for path in (ROOT / "pipeline").iterdir() if path.name != "__pycache__"}
    wanted |= {name: ROOT / name for name in ("stages", "conf")}
    for link in package.iterdir():
        if link.is_symlink() and link.name not in wanted:  # a program that ran from here leaves its cache
            link.unlink()
    for name, target in wanted.items():
        link = package / name
        if not link.is_symlink():
            link.symlink_to(target)


if __name__ == "__main__":
    link_package(Path(sys.argv[1]))
