"""A recording on screen: what a lesson shows, with a moment that can be played but a run that is over."""

from time import monotonic_ns
from typing import NoReturn

from cbtui.engines.session import Deliver, Ended
from cbtui.looks.theme import Charset
from cbtui.runs.live.live_run import LiveRun
from cbtui.runs.live.replay import ReplayRun, of_recording
from cbtui.runs.recorded.recording_file import setup_of
from cbtui.runs.setup.changes import Changes, changes_in
from cbtui.screens.lesson import FRAMES_A_SECOND, LessonScreen
from cbtui.widgets.shell import Prompt
from sim.recording import Recording

_REFUSED = frozenset(
    {
        "call_service",
        "call_service_off",
        "prompt",
        "type",
        "reset_world",
        "run_again",
        "start_over",
        "threads",
        "group",
        "set_up",
        "record",
    }
)
"""Actions that need an engine."""


class ReplayScreen(LessonScreen):
    """Shows a recording: as far as it has been read at once, the rest while it is being read."""

    def __init__(self, recording: Recording, charset: Charset) -> None:
        self._recording = recording
        self._played_at = 0
        recorded = setup_of(recording.about)
        changes = Changes() if recorded is None else changes_in(recorded)
        super().__init__(of_recording(recording), _no_engine, charset, changes)

    def on_mount(self) -> None:
        """Start the clock that plays; there is nobody to carry out a line."""
        prompt = self.query_one(Prompt)
        prompt.disabled = True
        prompt.display = False
        self.set_interval(1 / FRAMES_A_SECOND, self.play)

    def _new_run(self, speed: float | None, deliver: Deliver, ended: Ended) -> LiveRun:
        return ReplayRun(self._recording, self._subject.set_up(None, speed), deliver, ended)

    @property
    def replay_run(self) -> ReplayRun:
        """The run on screen."""
        assert isinstance(self._run, ReplayRun)
        return self._run

    # playing

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Offer what has a meaning for a recording."""
        run = self.replay_run
        match action:
            case _ if action in _REFUSED:
                return False
            case "pause":
                return not run.paused
            case "resume":
                return run.paused
            case "slower":
                return run.speed != run.speeds[0]
            case "faster":
                return run.speed != run.speeds[-1]
        return super().check_action(action, parameters)

    def action_resume(self) -> None:
        """Play from the moment on screen; from the beginning, if that is the end."""
        if self._playhead.at is None:
            self._move(self._playhead.sought(0, self._run.timeline.end))
        self._played_at = monotonic_ns()
        super().action_resume()

    def play(self) -> None:
        """Show the moment that playing has come to by now."""
        if not self._run.paused:
            now = monotonic_ns()
            elapsed, self._played_at = now - self._played_at, now
            self._playhead = self.replay_run.played(self._playhead, elapsed)
            self._grown = True


def _no_engine(*_: object) -> NoReturn:
    raise NotImplementedError("a recording is shown without an engine")
