"""The screen of a recording, which can be played."""

from collections.abc import Callable
from time import monotonic_ns

from cbtui.looks.theme import Charset
from cbtui.runs.live.replay import RecordedRun, of_recording
from cbtui.runs.recorded.recording_file import setup_of
from cbtui.runs.setup.changes import Changes, changes_in
from cbtui.screens.parts.engine_keys import PaceKeys
from cbtui.screens.parts.frames import FRAMES_A_SECOND
from cbtui.screens.parts.navigation import TimeNavigation
from cbtui.screens.parts.part import ScreenHost
from cbtui.screens.parts.runs import RunController
from cbtui.screens.run import RunScreen
from sim.recording import Recording


class Playback(PaceKeys):
    """Plays a recording by moving the cursor at the chosen speed.

    ``clock`` tells real time in nanoseconds.
    """

    def __init__(
        self,
        host: ScreenHost,
        runs: RunController[RecordedRun],
        navigation: TimeNavigation,
        clock: Callable[[], int],
    ) -> None:
        super().__init__(host, runs)
        self._recorded = runs
        self._navigation = navigation
        self._clock = clock
        self._played_at = 0

    def action_resume(self) -> None:
        """Play from the cursor, or from the beginning if the cursor is at the end."""
        if self._navigation.playhead.at is None:
            self._navigation.seek(0)
        self._played_at = self._clock()
        super().action_resume()

    def play(self) -> bool:
        """Advance the cursor by the time since the last call; returns whether it is being played."""
        run = self._recorded.run
        if run.paused:
            return False
        now = self._clock()
        elapsed, self._played_at = now - self._played_at, now
        self._navigation.playhead = run.played(self._navigation.playhead, elapsed)
        return True


class ReplayScreen(RunScreen[RecordedRun]):
    """Shows a recording while it is being read."""

    def __init__(self, recording: Recording, charset: Charset) -> None:
        recorded = setup_of(recording.about)
        self._changes = Changes() if recorded is None else changes_in(recorded)
        subject = of_recording(recording)
        setup = subject.set_up(None, None)
        runs = RunController(
            lambda _, deliver, ended: RecordedRun(recording, setup, deliver, ended), self.post
        )
        super().__init__(subject, charset, runs)
        self._playback = Playback(self, runs, self.navigation, monotonic_ns)
        self.add_parts(self._playback)
        runs.begin(speed=None)

    @property
    def changes(self) -> Changes:
        """The changes that were made to the recorded program's set-up."""
        return self._changes

    def on_mount(self) -> None:
        """Start the playback timer."""
        self.set_interval(1 / FRAMES_A_SECOND, self.play)

    def play(self) -> None:
        """Show the current moment of playback."""
        if self._playback.play():
            self.go_on()
