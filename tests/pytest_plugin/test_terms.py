"""Terms of a test's run: each value is refused in the words of the command line's option of that name."""

from pathlib import Path
from typing import Any

import pytest

from cbtui.pytest_plugin.terms import BadTermsError, RunTerms


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"second": 3}, "cbtui knows no second=; there are seconds, calls"),
        ({"seconds": "5"}, "seconds='5': give a number, without quotation marks"),
        ({"seconds": -5}, "seconds=-5: a run cannot last -5 seconds; give more than 0"),
        ({"calls": 2.5}, "calls=2.5: give a list, such as [2.5]"),
        ({"calls": [-1]}, "calls=[-1]: -1 s is before the run begins"),
        ({"lines": ["ros2 topic list"]}, "give each line its moment, such as (2.0, 'ros2 topic list')"),
        ({"arguments": "-speed 1"}, "arguments='-speed 1': give a list"),
        ({"arguments": [1]}, "1 is not text"),
        ({"threads": 0}, "threads=0: an executor cannot have 0 threads here"),
        ({"groups": ["take"]}, "groups=['take']: give a dict, such as {'odom_callback': 'own'}"),
        ({"groups": {"take": "mine"}}, "'mine' is not a group; give own, shared"),
        ({"periods": {"tick": "x"}}, "'x' is not a number; give 0.001 to 3600 s"),
        ({"sensor_rate": True}, "sensor_rate=True: give a number"),
        ({"distro": "klted"}, "'klted' is no distribution; give humble, jazzy"),
        ({"schedules": 0}, "schedules=0: 0 are too few"),
        ({"seed": "x"}, "seed='x': 'x' is not a whole number"),
        ({"on": "ros1"}, "on='ros1': give 'model' or 'ros2'"),
        ({"limit": 0}, "limit=0: "),
        ({"python": "python3"}, "python= names the Python of a real ROS 2: give on='ros2' with it"),
    ],
)
def test_a_value_that_no_run_can_have_is_refused_in_a_sentence(given: dict[str, Any], said: str) -> None:
    with pytest.raises(BadTermsError) as refused:
        RunTerms().changed(given)
    assert said in str(refused.value)
    assert "\n" not in str(refused.value)


def test_an_input_behind_the_end_is_refused() -> None:
    with pytest.raises(BadTermsError, match="a call at 20 s comes when the run of 2 s is over"):
        RunTerms(seconds=2, calls=[20]).setup(None, [Path("node.py")])


def test_a_python_without_rclpy_is_refused() -> None:
    with pytest.raises(BadTermsError, match="on='ros2': python /nowhere: there is no such program"):
        RunTerms(on="ros2", python="/nowhere").setup(None, [Path("node.py")])


@pytest.mark.parametrize(("seed", "wanted"), [(17, 17), ("17", 17), ("moves:3=1", "moves:3=1"), ("0", 0)])
def test_an_order_is_named_as_a_failure_or_explore_names_it(seed: int | str, wanted: int | str) -> None:
    assert list(RunTerms(seed=seed).seeds) == [wanted]
