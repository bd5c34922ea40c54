"""The site: it loads nothing from elsewhere, and shows each tutorial. `make site` builds it with warnings as errors."""

import os
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


def test_links_between_pages_lead_somewhere_in_a_checkout_too():
    """On a code host pages are files: a page that exists on the site alone cannot be followed there."""
    docs = PROJECT_ROOT / "docs"
    for page in docs.rglob("*.md"):
        for target in re.findall(r"\]\(([^)\s]+)\)", page.read_text(encoding="utf-8")):
            if "://" not in target and not target.startswith("#"):
                assert (page.parent / target.partition("#")[0]).exists(), (page.name, target)


def build(folder, pages, **environment):
    """Build a small site of these pages by the project's own configuration."""
    whole = yaml.safe_load((PROJECT_ROOT / "mkdocs.yml").read_text(encoding="utf-8"))
    kept = ("site_name", "theme", "markdown_extensions", "use_directory_urls", "validation")
    configuration = {key: whole[key] for key in kept} | {"hooks": [str(PROJECT_ROOT / "tools/site_hooks.py")]}
    for name, text in {"mkdocs.yml": yaml.safe_dump(configuration), **pages}.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text, encoding="utf-8")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict"]
    return subprocess.run(command, cwd=folder, env=os.environ | environment, capture_output=True, text=True)


@pytest.mark.slow
def test_a_broken_link_is_an_error(tmp_path):
    done = build(tmp_path, {"docs/index.md": "[nowhere](nowhere.md)\n"})
    assert done.returncode == 1
    assert "nowhere.md" in done.stderr


@pytest.mark.slow
@pytest.mark.parametrize(("environment", "output"), [({}, False), ({"SIMGAP_RUN_TUTORIALS": "1"}, True)])
def test_a_tutorial_is_run_where_that_is_wanted(tmp_path, environment, output):
    pages = {"docs/index.md": "[one](tutorials/one.md)\n", "docs/tutorials/one.py": "# %%\nprint(6 * 111)\n"}
    done = build(tmp_path, pages, **environment)
    assert done.returncode == 0, done.stderr
    assert ("666" in (tmp_path / "site" / "tutorials" / "one.html").read_text(encoding="utf-8")) == output


@pytest.mark.slow
def test_a_link_to_a_tutorials_script_leads_to_its_page_on_the_site(tmp_path):
    pages = {
        "docs/index.md": "[one](tutorials/one.py#the-end)\n",
        "docs/how_to/two.md": "[one](../tutorials/one.py)\n",
        "docs/tutorials/one.py": "# %% [markdown]\n# ## The end\n",
    }
    done = build(tmp_path, pages)
    assert done.returncode == 0, done.stderr
    assert 'href="tutorials/one.html#the-end"' in (tmp_path / "site" / "index.html").read_text("utf-8")
    assert 'href="../tutorials/one.html"' in (tmp_path / "site" / "how_to" / "two.html").read_text("utf-8")


@pytest.mark.slow
def test_a_tutorial_that_fails_stops_the_site(tmp_path):
    pages = {"docs/index.md": "text\n", "docs/tutorials/one.py": "# %%\n1 / 0\n"}
    done = build(tmp_path, pages, SIMGAP_RUN_TUTORIALS="1")
    assert done.returncode == 1
    assert "one.py:2: this cell failed" in done.stderr


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
