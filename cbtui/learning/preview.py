"""The first seconds of a lesson, run headless at full speed for the menu's preview."""

from threading import Event
from typing import TYPE_CHECKING

from cbtui.engines.follow import EngineLostError, FollowedRun, RunTimeoutError
from lessons.catalogue import is_built_in
from lessons.lesson import Lesson
from sim.files.untrusted import program_text
from sim.quantities.nanoseconds import SECOND

if TYPE_CHECKING:
    from cbtui.engines.session import OpenSession
    from sim.engine.setup import RunSetup
    from sim.trace.timeline import Timeline

LENGTH = 20 * SECOND
"""Length of a preview run in nanoseconds of its own time."""
CALLS = (5 * SECOND, 7 * SECOND)
"""Times at which the lesson's service is called: some lessons show nothing without a call."""
_TIMEOUT = 30.0
"""Limit of a preview run in real seconds."""


class CannotPreviewError(Exception):
    """A preview failed; the text is a sentence."""


def why_no_preview(lesson: Lesson) -> str | None:
    """Return why a lesson has no preview; None if it has one."""
    if not is_built_in(lesson):
        return "it comes from somebody else, and runs only once you open it"
    if lesson.setup.clock == "real":
        return f"on the real clock that would take {LENGTH / SECOND:g} s of computing"
    return None


def code_asked_about(lesson: Lesson) -> str:
    """Return the source of a lesson's node from its first class on; "" if it cannot be read."""
    source = program_text(lesson.node_path) or ""
    return source[source.find("\nclass ") + 1 :]


class PreviewRun:
    """A preview run. ``run`` blocks and needs its own thread; ``give_up`` is for any other."""

    def __init__(self, lesson: Lesson, open_session: "OpenSession") -> None:
        self.lesson = lesson
        self._open_session = open_session
        self._given_up = Event()
        self._ended = Event()

    def give_up(self) -> None:
        """Make ``run`` end its engine and return. Idempotent."""
        self._given_up.set()

    def wait(self, seconds: float) -> None:
        """Wait for the engine's end, at most a number of real seconds."""
        self._ended.wait(seconds)

    def run(self) -> "Timeline":
        """Run the lesson; the engine has ended when this returns or raises.

        Raises:
            CannotPreviewError: the run failed, or the lesson has no preview.
            GivenUpError: ``give_up`` was called.
        """
        try:
            return self._run()
        finally:
            self._ended.set()

    def _run(self) -> "Timeline":
        reason = why_no_preview(self.lesson)
        if reason is not None:
            raise CannotPreviewError(reason)
        from sim.trace.timeline import Timeline  # on this thread, as the screen must not wait for numpy

        timeline = Timeline(until_ending=True)
        with FollowedRun(preview_setup(self.lesson), self._open_session, self._given_up) as run:
            try:
                run.start()
                run.limit(_TIMEOUT)
                for batch in run:
                    timeline.extend(batch)
            except OSError as error:
                sentence = f"the engine could not be started: {error.strerror or error}"
                raise CannotPreviewError(sentence) from None
            except RunTimeoutError:
                raise CannotPreviewError(f"it did not end within {_TIMEOUT:g} s") from None
            except EngineLostError as error:
                raise CannotPreviewError(str(error)) from None
        return timeline


def preview_setup(lesson: Lesson) -> "RunSetup":
    """Return the set-up of a lesson's short run: its own, on virtual time."""
    from cbtui.runs.setup.lesson_setup import RunRequest

    return RunRequest(lesson=lesson, seconds=LENGTH / SECOND, calls=[at / SECOND for at in CALLS]).setup()
