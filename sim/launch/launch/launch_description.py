"""``launch.LaunchDescription``: what a launch file returns."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from sim.launch.launch.action import LaunchDescriptionEntity

if TYPE_CHECKING:
    from sim.launch.launch.actions.arguments import DeclareLaunchArgument
    from sim.launch.launch.launch_context import LaunchContext


class LaunchDescription:
    """A list of entities, visited in order."""

    def __init__(
        self,
        initial_entities: Iterable[LaunchDescriptionEntity] | None = None,
        *,
        deprecated_reason: str | None = None,
    ) -> None:
        self._entities: list[LaunchDescriptionEntity] = []
        self._deprecated_reason = deprecated_reason
        for entity in initial_entities or ():
            self.add_entity(entity)

    def add_entity(self, entity: LaunchDescriptionEntity) -> None:
        """Append an entity.

        Raises:
            TypeError: ``entity`` is not an entity.
        """
        if not isinstance(entity, LaunchDescriptionEntity):
            raise TypeError(f"a LaunchDescription holds actions, not {entity!r}")
        self._entities.append(entity)

    def add_action(self, action: LaunchDescriptionEntity) -> None:
        """Append an action."""
        self.add_entity(action)

    @property
    def entities(self) -> list[LaunchDescriptionEntity]:
        """The entities."""
        return self._entities

    @property
    def deprecated(self) -> bool:
        """Whether it should not be used any more."""
        return self._deprecated_reason is not None

    @property
    def deprecated_reason(self) -> str | None:
        """Why it should not be used any more."""
        return self._deprecated_reason

    def get_launch_arguments(self) -> list[DeclareLaunchArgument]:
        """Return the arguments declared here and in included files that are known before the launch."""
        from sim.launch.launch.actions.arguments import DeclareLaunchArgument

        return [each for each in _all_inside(self) if isinstance(each, DeclareLaunchArgument)]

    def visit(self, context: LaunchContext) -> Iterable[LaunchDescriptionEntity]:
        if self._deprecated_reason is not None:
            context.say(f"This launch file is deprecated: {self._deprecated_reason}", "WARNING")
        return self._entities

    def parts(self) -> Iterable[LaunchDescriptionEntity]:
        return self._entities


def _all_inside(entity: LaunchDescriptionEntity) -> Iterator[LaunchDescriptionEntity]:
    for each in entity.parts():
        yield each
        yield from _all_inside(each)
