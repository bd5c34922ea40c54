"""Held signals at common times."""

from typing import Any

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from simgap.logs.common_times import commanded_at
from simgap.logs.log import Signal

STEPS = st.lists(st.sampled_from([0.1, 0.2, 0.74, 0.76, 1.0, 1.24, 1.26, 3.0]), min_size=2, max_size=12)


@given(steps=STEPS, data=st.data())
def test_one_command_at_each_time_is_what_it_is_among_earlier_ones(steps: list[float], data: Any) -> None:
    times = np.cumsum([5.0, *steps])
    values = np.array(data.draw(st.lists(st.floats(-9, 9), min_size=len(times), max_size=len(times))))
    alone = commanded_at(Signal("u", times, values, held=True), times)
    # With one more command long before, the times are not the same.
    earlier = Signal("u", np.append(0.0, times), np.append(7.0, values), held=True)
    np.testing.assert_allclose(alone, commanded_at(earlier, times), rtol=0, atol=1e-12)
