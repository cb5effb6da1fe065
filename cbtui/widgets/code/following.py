"""Where the source goes by itself: to callbacks that run for a while, and to those that steps are about."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from cbtui.widgets.code.marks import CallbackMark
from cbtui.widgets.code.source_files import SourceFile, SourceFiles
from sim.trace.events import EntityId
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline


class Step(NamedTuple):
    """A decision that somebody stepped to: its moment, its place among those of the moment, its callback."""

    at: Nanoseconds
    place: int
    about: EntityId


class CallbackLines(NamedTuple):
    """The lines of a callback in a file, counted from 1."""

    file: SourceFile
    first: int
    last: int


class CallbackFollower:
    """Decides to which callback the source goes; ``placed`` tells whether it has gone to any place yet."""

    def __init__(self) -> None:
        self.placed = False
        self._long: set[tuple[Path, int]] = set()
        self._step: Step | None = None

    def forget(self, *, placed: bool) -> None:
        """Begin with another run."""
        self.placed, self._long, self._step = placed, set(), None

    def begun(
        self, marks: Mapping[SourceFile, Sequence[CallbackMark]], here: SourceFile
    ) -> CallbackLines | None:
        """Return a callback that has newly run for a while; at first, any.

        One of another file than that on screen only if nothing in this one runs as long.
        """
        long = [
            CallbackLines(file, mark.first_line, mark.last_line)
            for file, marked in marks.items()
            for mark in marked
            if mark.running_long
        ]
        begun = [each for each in long if (each.file.path, each.first) not in self._long]
        self._long = {(each.file.path, each.first) for each in long}
        if not self.placed and marks:
            self.placed = True
            file = here if marks.get(here) else next(iter(marks))
            first = marks[file][0]
            begun = begun or [CallbackLines(file, first.first_line, first.last_line)]
        inside = [each for each in begun if each.file is here]
        is_busy = any(each.file is here for each in long)
        return next(iter(inside or (begun if not is_busy else [])), None)

    def stepped(self, step: Step | None, timeline: Timeline, files: SourceFiles) -> CallbackLines | None:
        """Return the callback that a step is about, unless it is the last step again."""
        if step is None or step == self._step:
            return None
        self._step = step
        entity = timeline.entities.get(step.about)
        file = None if entity is None else files.of(entity.file)
        if entity is None or file is None:
            return None
        self.placed = True
        return CallbackLines(file, entity.first_line, entity.last_line)
