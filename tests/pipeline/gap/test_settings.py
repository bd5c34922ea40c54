import pytest

from simgap.errors import InputError
from simgap.gap.settings import Gap


def test_the_defaults_are_in_range():
    Gap().check()


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("horizon", -1.0),
        ("folds", 1),
        ("folds", -1),
        ("block_duration", 0.0),
        ("least_share", 5.0),
        ("budget", 0.0),
        ("least_probability", -0.1),
        ("margin", -0.5),
        ("most_effects", 0),
    ],
)
def test_a_number_out_of_its_range_is_refused_by_name(key, value):
    with pytest.raises(InputError, match=f"gap.{key}"):
        Gap(**{key: value}).check()
