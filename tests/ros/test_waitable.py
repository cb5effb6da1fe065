"""Waitables written by a program are refused by name; their counts add up."""

import pytest

from sim.ros.callback_groups import ReentrantCallbackGroup
from sim.ros.waitable import NumberOfEntities, Waitable


def test_counts_of_entities_add_up() -> None:
    total = NumberOfEntities(1, num_events=2) + NumberOfEntities(3, 4)
    assert total == NumberOfEntities(num_subscriptions=4, num_guard_conditions=4, num_events=2)


def test_a_waitable_is_refused_by_name() -> None:
    class Mine(Waitable):
        pass

    with pytest.raises(NotImplementedError, match=r"^rclpy.waitable.Waitable is not supported$"):
        Mine(ReentrantCallbackGroup())
