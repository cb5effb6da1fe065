"""A lesson's first seconds, run headless and as fast as it goes, for the menu to draw them small."""

from threading import Event
from typing import TYPE_CHECKING

from cbtui.engines.follow import EngineLostError, FollowedRun, RunTimeoutError
from lessons.catalogue import is_built_in
from lessons.lesson import Lesson
from sim.units import SECOND

if TYPE_CHECKING:
    from cbtui.engines.session import OpenSession
    from sim.engine.setup import RunSetup
    from sim.trace.timeline import Timeline

LENGTH = 20 * SECOND
"""How long such a run lasts in its own time: nanoseconds."""
CALLS = (5 * SECOND, 7 * SECOND)
"""When the lesson's service is called in it, as ``s`` would: a lesson on a service shows nothing without."""
_TIMEOUT = 30.0
"""Real seconds after which a run that has not come to its end is given up."""


class CannotPreviewError(Exception):
    """A lesson that could not be run; the text is a sentence."""


def why_no_preview(lesson: Lesson) -> str | None:
    """Return why a lesson is not run before it is opened; None if it can be."""
    if not is_built_in(lesson):
        return "it comes from somebody else, and is only run once you open it"
    if lesson.setup.clock == "real":
        return f"on the real clock that would take {LENGTH / SECOND:g} s of computing"
    return None


class PreviewRun:
    """One such run. ``run`` blocks a thread of its own, ``give_up`` may be called from any other."""

    def __init__(self, lesson: Lesson, open_session: "OpenSession") -> None:
        self.lesson = lesson
        self._open_session = open_session
        self._given_up = Event()
        self._ended = Event()

    def give_up(self) -> None:
        """Let ``run`` end its engine and come back; again does nothing."""
        self._given_up.set()

    def wait(self, seconds: float) -> None:
        """Wait until the engine has ended, no longer than so many real seconds."""
        self._ended.wait(seconds)

    def run(self) -> "Timeline":
        """Run the lesson; its engine has ended when this comes back, whatever way.

        Raises:
            CannotPreviewError: the run did not come to its end, or its lesson runs on the real clock or is
                none of the package's own.
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
        from sim.trace.timeline import Timeline  # numpy and all: on this thread, not on the screen's

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
                raise CannotPreviewError(f"it did not come to its end in {_TIMEOUT:g} s") from None
            except EngineLostError as error:
                raise CannotPreviewError(str(error)) from None
        return timeline


def preview_setup(lesson: Lesson) -> "RunSetup":
    """Return the set-up of a lesson's short run: its own, on virtual time."""
    from cbtui.runs.setup.lesson_setup import RunRequest

    return RunRequest(lesson=lesson, seconds=LENGTH / SECOND, calls=[at / SECOND for at in CALLS]).setup()
