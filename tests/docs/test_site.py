"""The site: it loads nothing from elsewhere, and shows each tutorial. `make site` builds it with warnings as errors."""

import re
import subprocess
import sys

import pytest
import yaml

from simgap.artifacts import PROJECT_ROOT
from simgap.effects import effects_of
from tools.link_package import link_package

LOADED = re.compile(r"<(?:script|link|img|iframe)\b[^>]*?(?:src|href)=\"(?:https?:)?//")


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    link_package(PROJECT_ROOT / "build" / "package")
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "--site-dir", str(folder)]
    done = subprocess.run(command, cwd=PROJECT_ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return folder


@pytest.mark.slow
def test_no_page_loads_anything_from_elsewhere(site):
    pages = list(site.rglob("*.html"))
    assert len(pages) > 20
    assert {page.name for page in pages if LOADED.search(page.read_text(encoding="utf-8"))} == set()


@pytest.mark.slow
def test_every_tutorial_has_a_page(site):
    scripts = sorted((PROJECT_ROOT / "docs" / "tutorials").glob("*.py"))
    for script in scripts:
        page = (site / "tutorials" / f"{script.stem}.html").read_text(encoding="utf-8")
        assert "import" in page
        assert "simgap" in page


def test_the_readme_is_short_and_its_links_lead_somewhere():
    readme = (PROJECT_ROOT / "README.md").read_text(encoding="utf-8")
    assert len(readme.splitlines()) <= 100
    targets = [target for target in re.findall(r"\]\(([^)]+)\)", readme) if "://" not in target]
    assert targets
    for target in targets:
        assert (PROJECT_ROOT / target.partition("#")[0]).exists(), target


@pytest.mark.slow
def test_a_broken_link_is_an_error(tmp_path):
    configuration = yaml.safe_load((PROJECT_ROOT / "mkdocs.yml").read_text(encoding="utf-8"))
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "index.md").write_text("[nowhere](nowhere.md)\n")
    kept = ("site_name", "theme", "markdown_extensions", "validation")
    (tmp_path / "mkdocs.yml").write_text(yaml.safe_dump({key: configuration[key] for key in kept}))
    command = [sys.executable, "-m", "mkdocs", "build", "--strict"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 1
    assert "nowhere.md" in done.stderr


def test_the_readme_says_how_many_effects_have_names():
    readme = (PROJECT_ROOT / "README.md").read_text(encoding="utf-8")
    for kind, row in {"quadrotor": "quadrotor", "swerve": "swerve drive", "joint": "single joint"}.items():
        names = {effect.name for effect in effects_of(kind) if effect.names_physics}
        assert f"| {row} | {len(names)} |" in readme


@pytest.mark.slow
def test_a_page_shows_a_file_of_the_repository_as_it_is(site):
    page = (site / "how_to" / "effect.html").read_text(encoding="utf-8")
    assert "ViscousFriction" in page
    assert "8&lt;--" not in page
