"""Which callbacks are ready, and the order in which they are served: rclpy's rules, without threads."""

from collections import deque
from collections.abc import Iterable
from operator import attrgetter

from sim.ros.scheduling.entity import Entity, OwnerNode

_serving_order = attrgetter("rank", "order")


def snapshot(nodes: Iterable[OwnerNode], now: int) -> deque[Entity]:
    """The entities that are ready at ``now`` and that their groups admit, in the order of service.

    Waitables of all nodes, then node by node timers, subscriptions, guard conditions, clients, services;
    within a kind, in creation order. Entities that are handed out, or whose group is busy, are left out.
    """
    ready: deque[Entity] = deque()
    waitables: list[Entity] = []
    for node in nodes:
        pending = node._agenda.collect_due(now)
        if pending:
            let_in = [
                each for each in pending if not each.handed_out and each.callback_group.can_execute(each)
            ]
            if len(let_in) > 1:
                let_in.sort(key=_serving_order)
            while let_in and let_in[0].rank < 0:
                waitables.append(let_in.pop(0))
            ready.extend(let_in)
    ready.extendleft(reversed(waitables))
    return ready


def in_order_of_readiness(ready: Iterable[Entity]) -> list[Entity]:
    """Ready entities in the order in which they became ready."""
    return sorted(ready, key=lambda each: each.node._agenda.ready[each])
