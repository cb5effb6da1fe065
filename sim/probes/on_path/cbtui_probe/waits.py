"""Finds callbacks that are ready but wait, while they wait, and why.

rclpy leaves the entities of a busy callback group out of its wait set, so its executor does not know that
they are ready. The probe uses a second wait set, which takes nothing and disturbs nothing. rcl forbids that
two concurrent waits share an entity, so the second one has only entities on which no executor waits now.
"""

from __future__ import annotations

from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

from .recorder import now
from .states import state_of

if TYPE_CHECKING:
    from .entities import Entities
    from .executors import Executors, Spinner
    from .recorder import Recorder
    from .states import WatchedEntity

GROUP_HELD, NO_FREE_WORKER, NOBODY_SPINS = "group held", "no free worker", "nobody spins"
EVENT_QUEUE = "behind others in the event queue"

_KINDS = ("subscription", "client", "service")
"""The kinds that the second wait set examines. A timer knows whether it is due, and triggers of guard
conditions are recorded. An action's waitable keeps its index in the latest wait set, so a second one would
confuse its executor: it counts as waiting from when it is taken until it runs."""


class Waits:
    """Looks for callbacks that wait. Not thread-safe."""

    def __init__(
        self, recorder: Recorder, entities: Entities, executors: Executors, rclpy_implementation: Any
    ) -> None:
        self._recorder = recorder
        self._entities = entities
        self._executors = executors
        self._rclpy = rclpy_implementation
        self._waiting: set[WatchedEntity] = set()

    def look(self) -> None:
        """Record all callbacks that wait now, and those that no longer wait without having run."""
        waiting = set()
        for node in list(self._entities.nodes):
            if node.context.ok():
                waiting |= self._look_at(node)
        for entity in self._waiting - waiting:
            entity.waits_no_more(self._recorder)
        self._waiting = waiting

    def _look_at(self, node: Any) -> set[WatchedEntity]:
        spinner = self._executors.serving(node)
        found: dict[WatchedEntity, int] = {}
        reasons: dict[WatchedEntity, tuple[str, int, bool]] = {}
        unsure: list[tuple[str, Any, WatchedEntity]] = []
        for kind in ("timer", "guard", "waitable", *_KINDS):
            for made in list(getattr(node, f"{kind}s")):
                entity = state_of(made)
                if entity is None or entity.number == 0:
                    continue
                reason = _reason(made, spinner)
                if reason is None:
                    continue
                reasons[entity] = reason
                if kind == "timer":
                    late = _lateness(made)
                    if late is not None:
                        found[entity] = now() - late
                elif kind == "guard" and entity.due:
                    found[entity] = entity.due
                elif made._executor_event:
                    found[entity] = now()
                elif kind not in _KINDS:
                    continue
                elif spinner is None or not spinner.waits or reason[0] == GROUP_HELD:
                    unsure.append((kind, made, entity))
        for entity in self._ready_of(node, unsure):
            found[entity] = now()
        for entity, since in found.items():
            entity.waits(self._recorder, since, reasons[entity])
        return set(found)

    def _ready_of(self, node: Any, unsure: list[tuple[str, Any, WatchedEntity]]) -> list[WatchedEntity]:
        """The entities for which something has arrived."""
        if not unsure:
            return []
        with ExitStack() as held:
            handles: list[tuple[str, Any, WatchedEntity]] = []
            for kind, made, entity in unsure:
                try:
                    held.enter_context(made.handle)
                except self._rclpy.InvalidHandle:
                    continue  # it was destroyed just now
                handles.append((kind, made.handle, entity))
            held.enter_context(node.context.handle)
            subscriptions, clients, services = (
                [each[1] for each in handles if each[0] == kind] for kind in _KINDS
            )
            wait_set = self._rclpy.WaitSet(
                len(subscriptions), 0, 0, len(clients), len(services), 0, node.context.handle
            )
            wait_set.clear_entities()
            for handle in subscriptions:
                wait_set.add_subscription(handle)
            for handle in clients:
                wait_set.add_client(handle)
            for handle in services:
                wait_set.add_service(handle)
            wait_set.wait(0)
            ready = {kind: set(wait_set.get_ready_entities(kind)) for kind in _KINDS}
            return [entity for kind, handle, entity in handles if handle.pointer in ready[kind]]


def _reason(made: Any, spinner: Spinner | None) -> tuple[str, int, bool] | None:
    """Why an entity would wait if it were ready: the reason, the holder, and whether no worker is free."""
    busy = [] if spinner is None else list(spinner.busy.values())
    full = spinner is not None and len(busy) >= spinner.threads
    if not made.callback_group.can_execute(made):
        holder = state_of(getattr(made.callback_group, "_active_entity", None))
        return GROUP_HELD, 0 if holder is None else holder.number, full
    if spinner is None or not spinner.is_spun():
        return NOBODY_SPINS, 0, False
    if not full:
        return None
    return NO_FREE_WORKER if spinner.asks_groups else EVENT_QUEUE, busy[0], True


def _lateness(timer: Any) -> int | None:
    """How long ago a timer fell due, in nanoseconds; None: it is not due."""
    try:
        if timer.is_canceled():
            return None
        left = timer.time_until_next_call()
    except Exception:  # noqa: BLE001 - destroyed or cancelled between the two, which rclpy tells in several ways
        return None
    return None if left is None or left > 0 else -left
