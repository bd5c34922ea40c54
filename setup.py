"""One import name for three folders: `simgap` is `pipeline/`, with `stages/` and `conf/` inside it."""

from setuptools import find_packages, setup

FOLDERS = {"simgap": "pipeline", "simgap.stages": "stages", "simgap.conf": "conf"}

setup(
    package_dir=FOLDERS,
    packages=[*FOLDERS, *(f"simgap.{package}" for package in find_packages("pipeline"))],
)
