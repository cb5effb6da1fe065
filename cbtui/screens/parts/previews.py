"""Previews of lessons: a lesson that stays highlighted is run in the background and drawn."""

import asyncio
from collections.abc import Callable
from typing import TYPE_CHECKING

from textual.message import Message
from textual.screen import Screen
from textual.timer import Timer

from cbtui.engines.follow import GivenUpError
from cbtui.keys.action import Scope
from cbtui.keys.keymap import keymap_of
from cbtui.learning.preview import CannotPreviewError, PreviewRun
from cbtui.looks.theme import Charset
from cbtui.widgets.miniature import PreviewPicture
from lessons.lesson import Lesson

if TYPE_CHECKING:
    from cbtui.engines.session import OpenSession

HOVER_DELAY = 0.3
"""Seconds that a lesson must be wanted before its preview is run."""
_EXIT_TIMEOUT = 1.0
"""Seconds to wait at exit for the engine of a preview, which is killed sooner."""


class Previews:
    """Runs each lesson once for its preview: one engine at a time, only while the screen is active.

    ``wanted`` returns the lesson to draw now, None if there is none.
    """

    class Drawn(Message):
        """A preview run has ended; ``subject`` is its picture, a sentence, or None if aborted."""

        def __init__(self, lesson: Lesson, subject: PreviewPicture | str | None) -> None:
            super().__init__()
            self.lesson = lesson
            self.subject = subject

    def __init__(
        self,
        screen: Screen[None],
        open_session: "OpenSession",
        charset: Charset,
        wanted: Callable[[], Lesson | None],
    ) -> None:
        self.subjects: dict[str, PreviewPicture | str] = {}
        """The previews by lesson ids: a picture, or a sentence on why there is none."""
        self._screen = screen
        self._open_session = open_session
        self._charset = charset
        self._wanted = wanted
        self._run: PreviewRun | None = None
        self._delay: Timer | None = None

    def schedule(self) -> None:
        """Run the wanted lesson after ``HOVER_DELAY``, unless another one is wanted by then."""
        self._stop_delay()
        lesson = self._wanted()
        if lesson is not None and lesson.id not in self.subjects:
            self._delay = self._screen.set_timer(HOVER_DELAY, self._draw)

    def suspend(self) -> None:
        """Abort the preview, as another engine may start now."""
        self._stop_delay()
        if self._run is not None:
            self._run.give_up()

    async def leave(self) -> None:
        """Wait for the preview's engine to end."""
        if self._run is not None:
            self._run.give_up()
            await asyncio.to_thread(self._run.wait, _EXIT_TIMEOUT)

    def take(self, drawn: Drawn) -> None:
        """Store a preview, and continue with the lesson that is wanted now."""
        self._run = None
        if drawn.subject is not None:
            self.subjects[drawn.lesson.id] = drawn.subject
        self._draw()

    def _stop_delay(self) -> None:
        if self._delay is not None:
            self._delay.stop()

    def _draw(self) -> None:
        """Start the preview of the wanted lesson, after aborting another one."""
        lesson = self._wanted()
        if lesson is None or lesson.id in self.subjects or not self._screen.is_active:
            return
        if self._run is not None:
            if self._run.lesson is not lesson:
                self._run.give_up()
            return
        run = self._run = PreviewRun(lesson, self._open_session)
        self._screen.run_worker(lambda: self._draw_with(run, lesson), thread=True)

    def _draw_with(self, run: PreviewRun, lesson: Lesson) -> None:
        """Run a preview, on a worker thread."""
        subject: PreviewPicture | str | None
        try:
            timeline = run.run()
        except CannotPreviewError as error:
            subject = f"The preview failed: {error}."
        except GivenUpError:
            subject = None
        else:
            # imported on this thread, as the screen must not wait for it
            from cbtui.widgets.lanes import LanePainter
            from cbtui.widgets.robot import scene_of

            key = keymap_of(self._screen.app).sign(Scope.LESSON, "call_service", self._charset)
            lanes = LanePainter(self._charset, lesson.service.name, call_key=key)
            subject = PreviewPicture(timeline, lanes, scene_of(lesson, timeline, self._charset))
        self._screen.post_message(self.Drawn(lesson, subject))
