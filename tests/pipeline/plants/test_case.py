import pytest

from simgap.errors import InputError
from simgap.plants.case import PlantCase, Sensors


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
        (PlantCase(rate=5000.0), "record.rate"),
        (PlantCase(sensors=Sensors(position=-1.0)), "record.sensors.position"),
    ],
)
def test_a_case_that_cannot_be_flown_is_refused_by_its_key(case, message):
    with pytest.raises(InputError, match=message):
        case.check()


@pytest.mark.parametrize(
    ("case", "message"),
    [
        (PlantCase(effects={"rotor_fault": 0.2}), "give a mapping of loss_1, loss_2, loss_3, loss_4"),
        (PlantCase(effects={"rotor_fault": {"loss_5": 0.2}}), "loss_5"),
        (PlantCase(effects={"rotor_fault": {"loss_2": 0.9}}), "record.effects.rotor_fault.loss_2"),
        (PlantCase(effects={"rotor_drag": "much"}), "record.effects.rotor_drag.coefficient"),
        (PlantCase(outside={"ghosts": 1.0}), "did you mean 'gusts'"),
        (PlantCase(effects={"steady_wind": {"wind_x": 3.0}}), "moves nothing without drag"),
        (PlantCase(outside={"gusts": 2.0}), "moves nothing without drag"),
        (PlantCase(flights="sideways"), "record.flights"),
        (PlantCase(autopilot="none"), "record.autopilot"),
        (PlantCase(hidden=["motor_speed", "motor_command"]), "leave motor_speed or motor_command"),
        (PlantCase(hidden=["position"]), "record.hidden"),
        (PlantCase(charge=[0.9, 0.2]), "record.charge"),
        (PlantCase(estimates=-1.0), "record.estimates"),
    ],
)
def test_a_case_that_makes_no_sense_is_refused_by_its_key(case, message):
    with pytest.raises(InputError, match=message):
        case.check()


def test_a_number_is_the_strength_of_an_effect_and_a_mapping_gives_its_parameters():
    case = PlantCase(
        effects={"rotor_drag": 0.35, "slung_payload": 0.2, "rotor_fault": {"loss_2": 0.1}, "mass_error": 1.0}
    )
    assert case.strength("rotor_drag") == 0.35
    assert case.strength("slung_payload", "length") == 0.8
    assert [case.strength("rotor_fault", f"loss_{rotor}") for rotor in (1, 2, 3, 4)] == [0.0, 0.1, 0.0, 0.0]
    assert set(case.concealed) == {"rotor_drag", "slung_payload", "rotor_fault"}


def test_the_autopilot_is_trimmed_and_flights_go_low_where_that_is_called_for():
    assert not PlantCase(effects={"rotor_drag": 0.35, "mass_error": 1.2}).trimmed
    assert PlantCase(effects={"center_of_mass_offset": {"offset_x": 0.01}}).trimmed
    assert PlantCase(autopilot="trimmed").trimmed
    assert PlantCase(effects={"ground_effect": 1e-3}).flown == "low"
    assert PlantCase(effects={"ground_effect": 1e-3}, flights="level").flown == "level"
    assert PlantCase().flown == "varied"
