"""A screen with a run: it starts and ends engines, takes what they tell, and commands them."""

import asyncio
import threading
import time
from typing import TYPE_CHECKING, ClassVar, cast

import msgspec
from textual import on
from textual.message import Message

from cbtui.engines.session import Deliver, Ended
from cbtui.keys.actions import PANES, Scope
from cbtui.keys.keymap import keymap_of
from cbtui.looks.theme import Charset
from cbtui.runs.compared_runs import Side
from cbtui.runs.live.findings import Watch
from cbtui.runs.live.live_recording import Finish
from cbtui.runs.live.live_run import LiveRun, OpenSession
from cbtui.runs.live.playhead import Playhead
from cbtui.runs.recorded.recording_file import CannotRecordError
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.subject import Subject
from cbtui.screens.sized import SizedScreen
from cbtui.terminal.compositing import SparingCompositor
from cbtui.terminal.garbage_collector import collect_now, let_go_of_screen
from cbtui.terminal.processor import not_computing, waited
from lessons.lesson import Lesson
from sim.engine.setup import Keyboard
from sim.trace.events import AnyEvent
from sim.trace.figures.concurrency import Concurrency

if TYPE_CHECKING:
    from cbtui.app import CbtuiApp


_AT_ONCE = 256
"""Events that the screen takes before keys have their turn: of lines as long as they come, a megabyte."""
_PATIENCE = 1.0
"""Seconds for which a session waits for a screen that takes nothing: it may be gone."""
_LONGEST_REST = 0.1
"""Seconds after which more is handed over, however short of processors the machine is."""


class RunningScreen(SizedScreen[None]):
    """Holds a run and the moment that is on screen. What draws it marks itself stale here.

    Events come from the session's thread as one message a batch, and only make the timeline longer.
    """

    PANES_HERE: ClassVar[tuple[str, ...]] = PANES
    """The panes that there are, in the order of their keys."""
    FIRST_SPEED: ClassVar[float | None] = 1.0
    """How fast the first run goes; None is as fast as it can."""

    def __init__(
        self,
        subject: Subject,
        open_session: OpenSession,
        charset: Charset,
        changes: Changes | None = None,
    ) -> None:
        super().__init__()
        self._compositor = SparingCompositor()
        self._subject = subject
        self._open_session = open_session
        self._charset = charset
        self._changes = changes or Changes()
        self._runs = 0
        self._playhead = Playhead()
        self._before: Side | None = None
        self._pane = PANES[0]
        self._is_stale = True
        self._grown = False
        self._frames = 0
        self._finishing: set[asyncio.Task[None]] = set()
        self._left = False
        self._offered: tuple[object, ...] = ()
        self._begin(self.FIRST_SPEED)

    class Delivered(Message):
        """A batch of events of the run with this number."""

        def __init__(self, run: int, events: list[AnyEvent]) -> None:
            super().__init__()
            self.run = run
            self.events = events
            self.taken = threading.Event()

    class Over(Message):
        """The engine of the run with this number is gone; ``loss`` says how, if it should not be."""

        def __init__(self, run: int, loss: str | None) -> None:
            super().__init__()
            self.run = run
            self.loss = loss

    @property
    def lesson(self) -> Lesson | None:
        """The lesson that is run; None for a file."""
        return self._subject.lesson

    @property
    def live_run(self) -> LiveRun:
        """The run on screen."""
        return self._run

    @property
    def _stale(self) -> bool:
        """Whether there is more to show than that the run has gone on."""
        return self._is_stale

    @_stale.setter
    def _stale(self, stale: bool) -> None:
        self._is_stale = stale
        if stale and self.is_running:
            self.call_next(self._draw_at_once)

    def _draw_at_once(self) -> None:
        """Show it before the next frame is due, if that can be."""
        raise NotImplementedError

    def on_mount(self) -> None:
        """Have old garbage gone before the first key: collecting it takes longer than drawing."""
        self.call_after_refresh(collect_now)

    async def on_unmount(self) -> None:
        """End the engine and every recording, whatever way the screen is left."""
        self._left = True
        let_go_of_screen()
        saved = await asyncio.to_thread(self._run.stop)
        if saved is not None:
            cast("CbtuiApp", self.app).tell_saved(saved)
        await asyncio.gather(*self._finishing)

    def _finish(self, finish: Finish | None) -> None:
        """Write a file to its end while the screen goes on, and say then what it holds."""
        if finish is not None:
            task = asyncio.create_task(self._tell_when_finished(finish))
            self._finishing.add(task)
            task.add_done_callback(self._finishing.discard)

    async def _tell_when_finished(self, finish: Finish) -> None:
        sentence = await asyncio.to_thread(finish)
        if self._left:
            cast("CbtuiApp", self.app).tell_saved(sentence)
        else:
            self._tell(sentence)

    def _deliver(self, run: int, events: list[AnyEvent]) -> None:
        """Hand a batch over, in parts.

        Another thread is held up until the screen has taken a part, and then rests for as long as both had
        to wait for a processor: a process that always wants one gets it late when a key comes.
        """
        for first in range(0, len(events), _AT_ONCE):
            message = self.Delivered(run, events[first : first + _AT_ONCE])
            before = not_computing()
            self._hand_over(message)
            if threading.current_thread() is not threading.main_thread():
                message.taken.wait(_PATIENCE)
                time.sleep(min(waited(before), _LONGEST_REST))

    def _hand_over(self, message: Message) -> None:
        """Bring something from the session's thread to the screen's; one that is closing lets it drop."""
        self.post_message(message)

    @on(Delivered)
    def _take(self, message: Delivered) -> None:
        message.taken.set()
        if message.run == self._runs:
            self._tell(self._run.take(message.events))
            self._grown = True

    @on(Over)
    def _note_the_end(self, message: Over) -> None:
        if message.run == self._runs:
            self._finish(self._run.over(message.loss))
            self._stale = True

    def _start(self) -> None:
        """Start the first run, when the screen is there."""
        self._tell(self._run.start())

    def _begin(self, speed: float | None) -> None:
        """Set up another run; what the engine of the one before still sends no longer counts."""
        self._runs += 1
        number = self._runs
        self._run = self._new_run(
            speed,
            lambda events: self._deliver(number, events),
            lambda loss: self._hand_over(self.Over(number, loss)),
        )
        self._concurrency = Concurrency(self._run.timeline)
        self._watch = Watch(self._run.timeline)
        self._playhead = self._playhead.live()
        self._stale = True

    def _new_run(self, speed: float | None, deliver: Deliver, ended: Ended) -> LiveRun:
        """A run of what is on screen."""
        setup = self._changes.applied(self._subject.set_up(self._changes.threads, speed))
        setup = msgspec.structs.replace(setup, keyboard=Keyboard.LIVE)
        return LiveRun(setup, self._open_session, deliver, ended)

    def _move(self, playhead: Playhead) -> None:
        self._playhead = playhead
        self._stale = True

    def _redraw(self) -> None:
        self._stale = True

    def _tell(self, sentence: str | None) -> None:
        """Say something that goes by."""
        if sentence is not None:
            self.notify(sentence, markup=False)

    def action_call_service(self) -> None:
        """Call the lesson's service with true."""
        self._run.call(True)

    def action_call_service_off(self) -> None:
        """Call the lesson's service with false."""
        self._run.call(False)

    def action_pause(self) -> None:
        """Stop time."""
        self._run.pause()
        self._stale = True

    def action_resume(self) -> None:
        """Let time go on."""
        self._run.resume()
        self._stale = True

    def action_reset_world(self) -> None:
        """Put the robot back to its start."""
        self._run.reset_world()

    def action_slower(self) -> None:
        """Let time pass more slowly."""
        self._run.change_speed(-1)
        self._stale = True

    def action_faster(self) -> None:
        """Let time pass faster."""
        self._run.change_speed(1)
        self._stale = True

    def action_record(self) -> None:
        """Begin a recording of this run, or end it."""
        if self._run.recorded is not None:
            self._finish(self._run.end_recording())
        else:
            try:
                key = keymap_of(self.app).sign(Scope.LESSON, "record", self._charset)
                self._tell(self._run.record(key))
            except CannotRecordError as error:
                self._tell(str(error))
        self._stale = True

    def action_next_lesson(self) -> None:
        """Open the next lesson."""
        if self._subject.following is not None:
            cast("CbtuiApp", self.app).open_lesson(self._subject.following)

    def action_exercise(self) -> None:
        """Go to the lesson's exercise."""
        if self.lesson is not None:
            cast("CbtuiApp", self.app).open_exercise(self.lesson)

    def action_lesson(self) -> None:
        """Open the lesson from its beginning."""
        if self.lesson is not None:
            cast("CbtuiApp", self.app).open_lesson(self.lesson)

    def action_leave(self) -> None:
        """Go back to the menu."""
        self.dismiss()
