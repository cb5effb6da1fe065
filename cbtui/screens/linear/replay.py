"""A recording in lines, which can be played."""

from time import monotonic_ns

from cbtui.runs.live.replay import RecordedRun, facts_on, of_recording
from cbtui.screens.linear.console import LinearConsole, LineTerminal
from cbtui.screens.linear.dialogue import Dialogue
from cbtui.screens.parts.playback import Playback
from sim.recording import Recording


class ReplayConsole(LinearConsole[RecordedRun]):
    """Prints the news of a recording as it is played, and the moments that the user goes to."""

    def __init__(self, terminal: LineTerminal, recording: Recording) -> None:
        self._recording = recording
        subject = of_recording(recording)
        setup = subject.set_up(None, None)
        super().__init__(
            terminal, subject, lambda _, deliver, ended: RecordedRun(recording, setup, deliver, ended)
        )
        self._playback = Playback(self, self.runs, self.navigation, monotonic_ns)
        self.add_parts(self._playback)
        self.runs.begin(None)
        self.telling.begin()

    @property
    def is_ready(self) -> bool:
        """Whether the recording has been read."""
        return self.runs.run.is_read

    def greet(self) -> Dialogue:
        """Print the facts about the recording, and start reading it."""
        self.tell(f"Recording of {self.subject.heading}")
        self.tell_page("\n".join(facts_on(self._recording)))
        play, back, on, go_to = map(self.key, ("resume", "step_back", "step", "go_to_time"))
        self.tell(f"{play} plays it, {back} and {on} go by an event, {go_to} to a moment. ? tells all keys.")
        self.runs.run.start()
        yield from ()

    def turn(self) -> None:
        """Advance the playback, and print the news."""
        if self.is_ready:
            if self._playback.play():
                self.telling.tell_news()
            self.telling.tell_state()
