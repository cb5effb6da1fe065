"""What the cycles of an executor ask of the workers that run what they yield."""

from collections.abc import Collection
from typing import Any, Protocol

from sim.ros.scheduling.task import Task


class Pool(Protocol):
    """The workers of an executor, as its cycles use them."""

    def may_serve(self) -> bool:
        """Whether found work may be served yet."""

    def may_go_ahead(self) -> bool:
        """Whether found work can be served before that."""

    def kept_busy(self) -> bool:
        """Whether the executor serves what it finds without waiting for the workers."""

    def asked_again(self) -> list[Task[Any]]:
        """The tasks that await, and have to be asked behind the callbacks that are queued, too."""

    def hand_over_again(self, fresh: Collection[Task[Any]]) -> bool:
        """Hand over what no worker has begun, except for ``fresh``; return whether that starts one."""
