import pytest

from pipeline.errors import InputError
from pipeline.reality.case import PlantCase, Sensors


def test_the_default_case_can_be_flown():
    PlantCase().check()
    assert PlantCase().strength("rotor_drag") == 0.0
    assert PlantCase().strength("mass_error") == 1.0


@pytest.mark.parametrize(
    ("case", "message"),
    [
        (PlantCase(effects={"rotor_drg": 0.3}), "did you mean 'rotor_drag'"),
        (PlantCase(effects={"rotor_drag": -0.3}), "record.effects.rotor_drag"),
        (PlantCase(effects={"mass_error": 0.0}), "record.effects.mass_error"),
        (PlantCase(runs=0), "record.runs"),
        (PlantCase(duration=-1.0), "record.duration"),
        (PlantCase(dropped=1.0), "record.dropped"),
        (PlantCase(jitter=0.01), "record.jitter"),
        (PlantCase(sensors=Sensors(position=-1.0)), "record.sensors.position"),
    ],
)
def test_a_case_that_cannot_be_flown_is_refused_by_its_key(case, message):
    with pytest.raises(InputError, match=message):
        case.check()
