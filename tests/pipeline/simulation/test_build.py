import pytest

from simgap.errors import InputError
from simgap.platforms import platform_to_config
from simgap.platforms.settings import SimulatorSettings
from simgap.simulation.build import build_simulator
from tests.pipeline.platforms.machines import JOINT, MACHINES


@pytest.mark.parametrize("kind", list(MACHINES))
def test_without_settings_the_simulator_is_the_platform(kind):
    simulator = build_simulator(platform_to_config(MACHINES[kind]), SimulatorSettings(), {})
    assert simulator.platform == MACHINES[kind]
    assert simulator.effects == ()


def test_effects_that_are_believed_are_known_and_what_is_not_said_has_its_default():
    settings = SimulatorSettings(effects={"coulomb_friction": {"level": 0.3}, "viscous_friction": {}})
    simulator = build_simulator(platform_to_config(JOINT), settings, {"position": "m"})
    assert simulator.known == simulator.effects
    assert simulator.position_unit == "m"
    assert [dict(fitted.values) for fitted in simulator.effects] == [{"level": 0.3}, {"coefficient": 0.01}]


@pytest.mark.parametrize(
    ("effects", "said"),
    [
        ({"coulomb": {}}, "did you mean 'coulomb_friction'?"),
        ({"rotor_drag": {}}, "unknown effect 'rotor_drag' for a joint"),
        (
            {"coulomb_friction": {"lvl": 1.0}},
            "simulator.effects.coulomb_friction: unknown parameter 'lvl'; use level",
        ),
    ],
)
def test_a_wrong_name_is_one_line_with_its_place(effects, said):
    with pytest.raises(InputError) as caught:
        build_simulator(platform_to_config(JOINT), SimulatorSettings(effects=effects), {})
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)
