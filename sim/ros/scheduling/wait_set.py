"""Which callbacks are ready, and in which order they are served: rclpy's rules, without threads."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sim.ros.scheduling.entity import Entity, OwnerNode


def _serving_order(entity: Entity) -> tuple[int, int]:
    return entity.rank, entity.order


def snapshot(nodes: Iterable[OwnerNode], now: int) -> deque[Entity]:
    """The entities that are ready at ``now`` and whose group lets them in, in the order of service.

    Waitables of all nodes, then node by node timers, subscriptions, guard conditions, clients, services;
    within a kind, in creation order. Entities that are handed out already are left out, and so are those of
    a busy group.
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


class WaitSet:
    """The one snapshot that an executor serves at a time. Used with the host's lock held."""

    def __init__(self) -> None:
        self._snapshot: deque[Entity] = deque()

    @property
    def exhausted(self) -> bool:
        """Whether the snapshot has been served to its end."""
        return not self._snapshot

    def look(self, nodes: Iterable[OwnerNode], now: int) -> None:
        """Take a new snapshot."""
        self._snapshot = snapshot(nodes, now)

    def clear(self) -> None:
        """Let go of what is left of the snapshot."""
        self._snapshot.clear()

    def keep(self, wanted: Callable[[Entity], bool]) -> None:
        """Let go of what is not wanted."""
        self._snapshot = deque(filter(wanted, self._snapshot))

    def next(self, now: int) -> Entity | None:
        """Yield the next of the snapshot that still holds, marked as handed out; None: it is exhausted."""
        while self._snapshot:
            entity = self._snapshot.popleft()
            if (
                not entity.handed_out
                and entity.still_ready(now)
                and entity.callback_group.can_execute(entity)
            ):
                entity.handed_out = True
                return entity
        return None
