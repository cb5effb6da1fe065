"""Playing a recording."""

from collections.abc import Callable
from dataclasses import replace

from cbtui.runs.live.replay import RecordedRun
from cbtui.screens.parts.engine_keys import PaceKeys
from cbtui.screens.parts.navigation import TimeNavigation
from cbtui.screens.parts.part import DrawnHost
from cbtui.screens.parts.runs import RunController


class Playback(PaceKeys):
    """Plays a recording by moving the cursor at the chosen speed.

    ``clock`` tells real time in nanoseconds.
    """

    def __init__(
        self,
        host: DrawnHost,
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
        self._navigation.playhead = replace(self._navigation.playhead, first=run.timeline.begun)
        if run.paused:
            return False
        now = self._clock()
        elapsed, self._played_at = now - self._played_at, now
        self._navigation.playhead = run.played(self._navigation.playhead, elapsed)
        return True
