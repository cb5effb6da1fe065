"""The screen of a recording, which can be played."""

from time import monotonic_ns

from cbtui.looks.theme import Charset
from cbtui.runs.live.replay import RecordedRun, of_recording
from cbtui.runs.recorded.recording_file import setup_of
from cbtui.runs.setup.changes import Changes, changes_in
from cbtui.screens.parts.frames import FRAMES_A_SECOND
from cbtui.screens.parts.keys import Absences
from cbtui.screens.parts.playback import Playback
from cbtui.screens.parts.runs import RunController
from cbtui.screens.run import RunScreen
from sim.recording import Recording


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
        absences = Absences(self, runs, None, lambda action: self._parts.offer(action, ()))
        self.add_parts(self._playback, absences)
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
