"""Published files come from the cache, the folder or the network, in this order, and are checked."""

import hashlib
import re
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer

import pytest
import yaml

from simgap.errors import InputError
from simgap.recordings import registry

CONTENT = b"t,voltage\n0,1\n"
NAME = "slow run.csv"


class Quiet(SimpleHTTPRequestHandler):
    def log_message(self, *_arguments):
        pass


@pytest.fixture
def world(tmp_path, monkeypatch):
    """A registry of one dataset, an empty cache, an empty folder, and a local server of the file."""
    served = tmp_path / "server" / "owner" / "robot" / ("0" * 40) / "logs"
    served.mkdir(parents=True)
    (served / NAME).write_bytes(CONTENT)
    server = ThreadingHTTPServer(("127.0.0.1", 0), partial(Quiet, directory=tmp_path / "server"))
    threading.Thread(target=server.serve_forever, args=(0.01,), daemon=True).start()
    address = f"http://127.0.0.1:{server.server_port}/"
    tables = tmp_path / "tables"
    tables.mkdir()
    table = {
        "title": "A robot",
        "repository": "owner/robot",
        "commit": "0" * 40,
        "licence": "CC0",
        "citation": "Somebody",
        "folders": [{"here": "raw", "there": "logs", "sha256": {NAME: hashlib.sha256(CONTENT).hexdigest()}}],
    }
    (tables / "robot.yaml").write_text(yaml.safe_dump(table))
    monkeypatch.setattr(registry, "_PUBLISHED_TABLES", tables)
    monkeypatch.setattr(registry, "_ADDRESS", address + "{repository}/{commit}/{path}")
    monkeypatch.setenv("SIMGAP_CACHE", str(tmp_path / "cache"))
    monkeypatch.setenv("SIMGAP_DATA", str(tmp_path / "data"))
    monkeypatch.setenv("NO_PROXY", "127.0.0.1")
    yield tmp_path
    server.shutdown()
    server.server_close()


def _put(folder):
    folder.mkdir(parents=True)
    (folder / NAME).write_bytes(CONTENT)
    return folder / NAME


def _offline(monkeypatch):
    monkeypatch.setattr(registry, "_ADDRESS", "http://127.0.0.1:9/{repository}/{commit}/{path}")


def test_the_cache_comes_first_then_the_folder_then_the_network(world):
    assert registry.locate("robot") == "download"
    in_folder = _put(world / "data" / "robot" / "raw")
    assert registry.locate("robot") == "SIMGAP_DATA"
    assert registry.fetch("robot") == [in_folder]
    in_cache = _put(world / "cache" / "robot" / "00000000" / "raw")
    assert registry.locate("robot") == "cache"
    assert registry.fetch("robot") == [in_cache]


def test_a_download_is_kept_in_the_cache(world, monkeypatch):
    (path,) = registry.fetch("robot", ["raw/*.csv"])
    assert path.read_bytes() == CONTENT
    assert path.is_relative_to(world / "cache")
    _offline(monkeypatch)
    assert registry.locate("robot") == "cache"
    assert registry.fetch("robot") == [path]


def test_without_a_network_one_line_says_so(world, monkeypatch):
    _offline(monkeypatch)
    assert registry.locate("robot") is None
    with pytest.raises(
        InputError, match=r"slow%20run\.csv: cannot be downloaded \(ConnectionError\).*SIMGAP_DATA"
    ):
        registry.fetch("robot")
    assert not list((world / "cache").rglob("*.csv"))


@pytest.mark.parametrize("place", ["cache/robot/00000000/raw", "data/robot/raw"])
def test_a_changed_file_is_refused(world, place):
    path = _put(world / place)
    path.write_bytes(CONTENT + b"1,2\n")
    with pytest.raises(InputError, match=re.escape(f"{path}: is not the published file (SHA-256")):
        registry.fetch("robot")


def test_a_changed_download_is_refused_and_not_kept(world):
    served = next((world / "server").rglob(NAME))
    served.write_bytes(b"something else")
    with pytest.raises(InputError, match="what was downloaded is not the published file"):
        registry.fetch("robot")
    assert not list((world / "cache").rglob("*.csv"))


def test_an_unknown_dataset_or_pattern(world):
    with pytest.raises(InputError, match=r"no published dataset 'robt'; did you mean 'robot'\?"):
        registry.published("robt")
    with pytest.raises(InputError, match="'sim/\\*' matches no file of 'robot'"):
        registry.fetch("robot", ["sim/*"])


@pytest.mark.parametrize("name", registry.published_names())
def test_every_entry_is_complete(name):
    entry = registry.published(name)
    assert re.fullmatch(r"[\w.-]+/[\w.-]+", entry.repository)
    assert re.fullmatch(r"[0-9a-f]{40}", entry.commit)
    assert entry.title
    assert entry.licence
    assert entry.citation
    assert entry.files
    for file in entry.files:
        assert re.fullmatch(r"[0-9a-f]{64}", file.sha256)
        assert " " not in file.address
        assert entry.commit in file.address


def test_what_has_no_licence_says_so():
    assert registry.published("nanodrone").licence == "none stated: evaluate and cite, never redistribute"


def test_the_shared_recordings_are_the_published_ones(shared_data, monkeypatch, tmp_path):
    monkeypatch.setenv("SIMGAP_DATA", str(shared_data))
    monkeypatch.setenv("SIMGAP_CACHE", str(tmp_path))
    for name in ("swerve_drive", "swerve_drive_sim", "flywheel"):
        assert registry.locate(name) == "SIMGAP_DATA"
        assert registry.fetch(name)
