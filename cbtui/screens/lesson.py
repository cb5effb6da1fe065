"""A lesson on screen: its run on lanes, the moment in words, and guide, source, robot and log."""

import asyncio
from collections.abc import Iterator
from typing import TYPE_CHECKING, ClassVar, cast

from textual import on
from textual.app import ComposeResult
from textual.binding import BindingType
from textual.containers import Container
from textual.events import DescendantFocus
from textual.message import Message
from textual.widget import Widget

from cbtui.actions import PANES, Scope, bindings_of
from cbtui.concurrency import Concurrency
from cbtui.live_run import Deliver, Ended, LiveRun, OpenSession, State
from cbtui.playhead import SPANS, Playhead
from cbtui.record import CannotRecordError
from cbtui.screens.layout import Layout
from cbtui.screens.moment import MomentScreen
from cbtui.screens.sized import SizedScreen
from cbtui.screens.threads import ThreadsScreen
from cbtui.subject import Subject
from cbtui.theme import Charset
from cbtui.widgets.arena_map import ArenaMap
from cbtui.widgets.code import CodeView
from cbtui.widgets.diagnosis import call_note, verdict
from cbtui.widgets.diagnosis_line import DiagnosisLine
from cbtui.widgets.guide import Guide
from cbtui.widgets.key_bar import KeyBar
from cbtui.widgets.lanes import Lanes
from cbtui.widgets.log import LogView
from cbtui.widgets.shell import Prompt, ShellOutput, ShellView
from cbtui.widgets.status_line import StatusLine, status_of
from cbtui.widgets.tabs import Tabs, title_of
from lessons.lesson import Lesson
from sim.trace.events import AnyEvent
from sim.trace.model import Nanoseconds

if TYPE_CHECKING:
    from cbtui.app import CbtuiApp

FRAMES_A_SECOND = 20


class LessonScreen(SizedScreen[None]):
    """Runs a lesson and shows it: everything on it is a function of the run's timeline and of a moment.

    Events come from the session's thread as one message a batch, and only make the timeline longer; a timer
    draws what there is new. However fast a run is, the screen is drawn ``FRAMES_A_SECOND`` times at most.
    """

    SCOPE = Scope.LESSON
    CSS_PATH = "lesson.tcss"
    BINDINGS: ClassVar[list[BindingType]] = [*bindings_of(Scope.LESSON)]
    AUTO_FOCUS = "#guide"

    class Delivered(Message):
        """A batch of events of the run with this number."""

        def __init__(self, run: int, events: list[AnyEvent]) -> None:
            super().__init__()
            self.run = run
            self.events = events

    class Over(Message):
        """The engine of the run with this number is gone; ``loss`` says how, if it should not be."""

        def __init__(self, run: int, loss: str | None) -> None:
            super().__init__()
            self.run = run
            self.loss = loss

    def __init__(self, subject: Subject, open_session: OpenSession, charset: Charset) -> None:
        super().__init__()
        self._subject = subject
        self._open_session = open_session
        self._charset = charset
        self._threads: int | None = None
        self._runs = 0
        self._playhead = Playhead()
        self._pane = PANES[0]
        self._stale = True
        self._offered: tuple[object, ...] = ()
        self._begin(speed=1.0)

    @property
    def lesson(self) -> Lesson | None:
        """The lesson that is run; None for a file."""
        return self._subject.lesson

    @property
    def live_run(self) -> LiveRun:
        """The run on screen."""
        return self._run

    def compose(self) -> ComposeResult:
        """Lay out lines, lanes and panes."""
        yield StatusLine()
        yield Lanes()
        yield Tabs()
        with Container(id="panes"):
            yield from self._panes()
        yield DiagnosisLine()
        yield KeyBar(Scope.LESSON, self._charset)

    def on_mount(self) -> None:
        """Start the run and the timer that draws it."""
        lanes, robot = self.query_one(Lanes), self.query_one(ArenaMap)
        lanes.charset = robot.charset = self._charset
        lanes.service = self._subject.service
        self._show(self._pane)
        self._run.start()
        self.set_interval(1 / FRAMES_A_SECOND, self._draw_if_stale)

    async def on_unmount(self) -> None:
        """End the engine, whatever way the screen is left."""
        await asyncio.to_thread(self._run.stop)

    # what the engine tells

    def _hand_over(self, message: Message) -> None:
        """Bring something from the session's thread to the screen's; one that is closing lets it drop."""
        self.post_message(message)

    @on(Delivered)
    def _take(self, message: Delivered) -> None:
        if message.run == self._runs:
            self._tell(self._run.take(message.events))
            self._stale = True

    @on(Over)
    def _note_the_end(self, message: Over) -> None:
        if message.run == self._runs:
            self._tell(self._run.over(message.loss))
            self._stale = True

    # drawing

    def draw(self) -> None:
        """Show the moment that the playhead is at."""
        self._stale = False
        if self.layout_now is Layout.SMALL:
            return
        run, timeline = self._run, self._run.timeline
        now = self._playhead.now(timeline.end)
        subject = self._subject
        self.query_one(StatusLine).status = status_of(subject.heading, run, self._playhead, subject.executor)
        lanes = self.query_one(Lanes)
        lanes.window, lanes.now, lanes.timeline = self._playhead.window(timeline.end), now, timeline
        line = self.query_one(DiagnosisLine)
        line.diagnosis = verdict(run, self._playhead, self._concurrency)
        line.note = call_note(timeline, now)
        for name in PANES:
            if self._widget(name).display:
                self._draw_pane(name)
        self._offer_keys()

    def laid_out(self) -> None:
        """Draw what the new layout shows."""
        self._stale = True

    def _draw_if_stale(self) -> None:
        if self._stale:
            self.draw()

    def _draw_pane(self, name: str) -> None:
        timeline = self._run.timeline
        now = self._playhead.now(timeline.end)
        match self._widget(name):
            case CodeView() | LogView() | ShellView() as view:
                view.show(timeline, now)
            case ArenaMap() as robot:
                robot.now, robot.timeline = now, timeline

    def _offer_keys(self) -> None:
        """Tell the line of keys when others have a meaning."""
        run = self._run
        offered = (run.state, self._playhead, run.speed, run.timeline.end > 0)
        if offered != self._offered:
            self._offered = offered
            self.query_one(KeyBar).changed()

    # runs

    def _begin(self, speed: float | None) -> None:
        """Set up another run; what the engine of the one before still sends no longer counts."""
        self._runs += 1
        number = self._runs
        self._run = self._new_run(
            speed,
            lambda events: self._hand_over(self.Delivered(number, events)),
            lambda loss: self._hand_over(self.Over(number, loss)),
        )
        self._concurrency = Concurrency(self._run.timeline)
        self._playhead = self._playhead.live()
        self._stale = True

    def _new_run(self, speed: float | None, deliver: Deliver, ended: Ended) -> LiveRun:
        """A run of what is on screen."""
        return LiveRun(self._subject.set_up(self._threads, speed), self._open_session, deliver, ended)

    async def _run_again(self) -> None:
        before = self._run
        self._begin(before.speed)
        await asyncio.to_thread(before.stop)
        self._run.start()

    # panes

    def _panes(self) -> Iterator[Widget]:
        robot = ArenaMap(id="robot")
        robot.can_focus = True
        guide = Guide(self._subject.guide, id="guide")
        code = CodeView(self._subject.node_path, self._subject.source, id="code")
        for pane in (guide, code, robot, LogView(id="log"), ShellView(id="shell")):
            assert pane.id is not None
            pane.border_title = title_of(pane.id)
            pane.add_class("pane")
            yield pane
        code.border_title = f"{title_of('code')} {self._subject.node_path.name}"

    def _widget(self, pane: str) -> Widget:
        return self.query_one(f"#{pane}")

    def _show(self, pane: str) -> None:
        """Make a pane the current one."""
        self._pane = pane
        for name in PANES:
            self._widget(name).set_class(name == pane, "-current", update=False)
        self._widget("log").set_class(pane == "shell", "-behind", update=False)
        self.update_node_styles(animate=False)
        self.query_one(Tabs).current = pane
        place = self._focus_of(pane)
        if not self._widget(pane).has_focus_within:
            place.focus()
        self._stale = True

    def _focus_of(self, pane: str) -> Widget:
        """What of a pane takes the keys."""
        return self.query_one(ShellOutput) if pane == "shell" else self._widget(pane)

    @on(Tabs.Picked)
    def _pick(self, message: Tabs.Picked) -> None:
        self._show(message.pane)

    def on_descendant_focus(self, event: DescendantFocus) -> None:
        """Make the pane current that the person clicked on."""
        ids = (widget.id for widget in event.widget.ancestors_with_self)
        pane = next((each for each in ids if each in PANES), None)
        if pane is not None and pane != self._pane:
            self._show(pane)
        self.query_one(KeyBar).show(Scope.PROMPT if isinstance(self.focused, Prompt) else Scope.LESSON)

    # the prompt

    @on(Prompt.Given)
    def _give_line(self, message: Prompt.Given) -> None:
        self._run.give_line(message.text)

    @on(Prompt.Interrupted)
    def _interrupt_line(self) -> None:
        self._run.interrupt_line()

    @on(Prompt.CompletionWanted)
    def _complete_line(self, message: Prompt.CompletionWanted) -> None:
        self._run.complete_line(message.text, message.cursor)

    # actions

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer what has a meaning now."""
        run, playhead = self._run, self._playhead
        typing = isinstance(self.focused, Prompt)
        meaningless = {
            "earlier": typing,
            "next_pane": typing,
            "prompt": not run.alive,
            "call_service": not run.alive,
            "call_service_off": not run.alive,
            "pause": not run.alive or run.paused,
            "resume": not run.alive or not run.paused,
            "step": playhead.at is None and not (run.virtual and run.state is State.PAUSED),
            "step_back": playhead.now(run.timeline.end) == 0,
            "reset_world": not run.alive,
            "record": not run.alive,
            "run_again": run.alive,
            "slower": not run.alive or run.speed == run.speeds[0],
            "faster": not run.alive or run.speed == run.speeds[-1],
            "live": playhead.at is None,
            "later": playhead.at is None or typing,
            "zoom_in": playhead.span == SPANS[0],
            "zoom_out": playhead.span == SPANS[-1],
            "next_lesson": self._subject.following is None,
        }
        return not meaningless.get(action, False)

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

    async def action_run_again(self) -> None:
        """Run again with the same threads and speed."""
        await self._run_again()

    def action_threads(self) -> None:
        """Ask for a number of threads."""
        self.app.push_screen(
            ThreadsScreen(self._subject.executor, self._threads, self._charset), self._run_with_threads
        )

    async def _run_with_threads(self, threads: int | None) -> None:
        if threads is not None:
            self._threads = threads or None
            await self._run_again()

    def action_slower(self) -> None:
        """Let time pass more slowly."""
        self._run.change_speed(-1)
        self._stale = True

    def action_faster(self) -> None:
        """Let time pass faster."""
        self._run.change_speed(1)
        self._stale = True

    def action_earlier(self) -> None:
        """Look further back."""
        self._move(self._playhead.moved(-1, self._run.timeline.end))

    def action_later(self) -> None:
        """Look less far back."""
        self._move(self._playhead.moved(1, self._run.timeline.end))

    def action_step(self) -> None:
        """Go on by one scheduling decision, or to the next event of what was looked back to."""
        if self._playhead.at is None:
            self._run.step()
        else:
            self._move(self._playhead.beside(self._run.timeline, 1))

    def action_step_back(self) -> None:
        """Look at the event before."""
        self._move(self._playhead.beside(self._run.timeline, -1))

    def action_go_to_time(self) -> None:
        """Ask for a moment."""
        run = self._run
        end = run.timeline.end
        self.app.push_screen(
            MomentScreen(self._playhead.now(end), end, run.alive, self._charset), self._go_to_time
        )

    def _go_to_time(self, moment: Nanoseconds | None) -> None:
        """Look back at a moment that has passed; have the run go on to one that has not."""
        if moment is None:
            return
        end = self._run.timeline.end
        self._move(self._playhead.sought(moment, end))
        if moment > end and self._run.alive:
            self._run.run_until(moment)

    def action_live(self) -> None:
        """Go back to the present."""
        self._move(self._playhead.live())

    def action_zoom_in(self) -> None:
        """Show a shorter stretch of time."""
        self._move(self._playhead.zoomed(-1))

    def action_zoom_out(self) -> None:
        """Show a longer stretch of time."""
        self._move(self._playhead.zoomed(1))

    def _move(self, playhead: Playhead) -> None:
        self._playhead = playhead
        self._stale = True

    def action_record(self) -> None:
        """Begin a recording of this run, or end it."""
        if self._run.recorded is not None:
            self._tell(self._run.end_recording())
        else:
            try:
                self._tell(self._run.record())
            except CannotRecordError as error:
                self._tell(str(error))
        self._stale = True

    def _tell(self, sentence: str | None) -> None:
        """Say something that goes by."""
        if sentence is not None:
            self.notify(sentence, markup=False)

    def action_prompt(self) -> None:
        """Let the person type a ros2 line."""
        self._show("shell")
        self.query_one(ShellView).focus_prompt()

    def action_show_pane(self, pane: str) -> None:
        """Go to a pane."""
        self._show(pane)

    def action_next_pane(self) -> None:
        """Go to the next pane."""
        self._show(PANES[(PANES.index(self._pane) + 1) % len(PANES)])

    def action_maximise(self) -> None:
        """Let the current pane fill the screen, or give the others their room back."""
        self.toggle_class("-maximised")
        self._stale = True

    def action_next_lesson(self) -> None:
        """Open the next lesson."""
        if self._subject.following is not None:
            cast("CbtuiApp", self.app).open_lesson(self._subject.following)

    def action_leave(self) -> None:
        """Go back to the menu."""
        self.dismiss()
