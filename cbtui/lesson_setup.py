"""From a lesson, or a learner's own file, to the set-up of a run of it."""

from collections.abc import Sequence
from pathlib import Path

from lessons.lesson import Lesson
from sim.engine.setup import RunSetup, ServiceChoice


def setup_for(lesson: Lesson, *, threads: int | None = None, speed: float | None = 1.0) -> RunSetup:
    """Return what an engine needs to run a lesson in virtual time.

    ``threads`` None leaves the lesson's own number; ``speed`` is virtual seconds per real second, None for
    as fast as it can.
    """
    return RunSetup(
        title=lesson.id,
        node_path=str(lesson.node_path),
        arguments=tuple(lesson.arguments_with(threads)),
        service=ServiceChoice(lesson.service.name, lesson.service.type),
        speed=speed,
        threads=threads,
    )


def setup_for_file(
    path: Path, arguments: Sequence[str] = (), *, threads: int | None = None, speed: float | None = 1.0
) -> RunSetup:
    """Return what an engine needs to run a program file, on wall time as it would run elsewhere."""
    return RunSetup(
        title=path.name,
        node_path=str(path.resolve()),
        arguments=tuple(arguments),
        clock="real",
        speed=speed,
        threads=threads,
    )
