"""`simgap motors`."""

import pytest

from simgap.platforms.motor_table import motors_page
from simgap.stages.motors import main


def run(*arguments: str) -> int:
    with pytest.raises(SystemExit) as ended:
        main(list(arguments))
    return int(ended.value.code or 0)


def test_it_lists_motors_describes_one_and_writes_the_page(tmp_path, capsys):
    assert run() == 0
    listed = capsys.readouterr().out
    assert "Kraken X60" in listed
    assert run("kraken-x60") == 0
    assert "resistance 0.0327869" in capsys.readouterr().out
    assert run("--write", str(tmp_path / "motors.md")) == 0
    assert (tmp_path / "motors.md").read_text(encoding="utf-8") == motors_page()


def test_a_wrong_name_is_one_line(capsys):
    assert run("Krakn X60") == 2
    error = capsys.readouterr().err
    assert error.startswith("simgap motors: motors: there is no motor 'Krakn X60'; did you mean 'Kraken X60'")
    assert error.count("\n") == 1
