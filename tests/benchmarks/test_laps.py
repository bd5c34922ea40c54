from benchmarks.laps import Laps, in_turns
from benchmarks.page import table


def test_the_median_and_the_spread_are_of_the_rounds():
    laps = Laps((3.0, 1.0, 2.0))
    assert laps.median == 2.0
    assert laps.spread == (1.0, 3.0)


def test_a_round_in_which_the_machine_was_slow_changes_no_ratio():
    quick, slow = Laps((10.0, 5.0, 10.0)), Laps((2.0, 1.0, 2.0))
    assert quick.over(slow) == 5.0
    assert slow.over(quick) == 0.2


def test_contenders_run_in_turns_and_each_round_begins_with_another():
    order = []

    def contender(name: str):
        def run() -> float:
            order.append(name)
            return float(len(order))

        return run

    laps = in_turns({name: contender(name) for name in "abc"}, rounds=2)
    assert "".join(order) == "abc" + "abc" + "bca"
    assert laps["b"].rates == (5.0, 7.0)


def test_a_table_has_a_line_for_each_row():
    assert table(["a", "b"], [["x", "1"]]) == "| a | b |\n| --- | --: |\n| x | 1 |\n"
