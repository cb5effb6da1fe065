"""Following a chain of messages: its path at the moment on screen, and what took its time."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial

from cbtui.runs.live.live_run import ShownRun
from cbtui.screens.parts.navigation import TimeNavigation
from cbtui.screens.parts.part import ScreenHost, ScreenPart
from cbtui.screens.parts.runs import RunController
from cbtui.screens.windows.chain import ChainScreen
from sim.quantities.durations import duration, timestamp
from sim.trace.figures.chains import Chain, ChainError, ChainRun, chain
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline

_GROWTH = 1.1
"""Factor by which a run has to grow until its chain is followed again."""


@dataclass
class ChainPath(ScreenPart):
    """Follows the chain of ``names``; without names it follows nothing."""

    host: ScreenHost
    runs: RunController[ShownRun]
    navigation: TimeNavigation
    names: Sequence[str] = ()
    _found: Chain | None = None
    _of: object = None
    _until: Nanoseconds = 0

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        """Offer it once a message was sent."""
        return bool(self.runs.timeline.names_sent)

    def action_chain(self) -> None:
        """Ask for the names."""
        timeline = self.runs.timeline
        follow = partial(chain, timeline)
        screen = ChainScreen(self.names, list(_names_used(timeline)), follow, self.host.charset)
        self.host.ask(screen, self._take)

    def _take(self, names: tuple[str, ...] | None) -> None:
        if names is not None:
            self.names, self._of = names, None
            self.host.redraw()

    @property
    def here(self) -> ChainRun | None:
        """The latest complete run of the chain that began before the moment on screen."""
        now = self.navigation.now
        begun = [each for each in self._chain.whole_chain if each.input.at <= now] if self._chain else []
        return max(begun, key=lambda each: each.input.at, default=None)

    @property
    def sentence(self) -> str:
        """How long that run of the chain took, and where; "" if there is none."""
        here, found = self.here, self._chain
        if here is None or found is None or found.critical is None:
            return ""
        dearest, slowest = here.longest_step, found.critical
        most = f", {duration(dearest.length)} of it: {dearest.words}" if dearest.length else ""
        way = f"{found.path[0]} to {found.path[-1]} took {duration(here.latency)}{most}"
        return f"{way}; the slowest {duration(slowest.latency)} at {timestamp(slowest.input.at)}"

    @property
    def _chain(self) -> Chain | None:
        """The chain of the run so far; it is followed again when the run has grown by ``_GROWTH``."""
        timeline = self.runs.timeline
        if not self.names:
            return None
        stands = self.runs.run.paused or timeline.ended is not None
        grown = timeline.end > self._until * (1 if stands else _GROWTH)
        if self._of is not timeline or grown:
            self._of, self._until = timeline, timeline.end
            try:
                self._found = chain(timeline, self.names)
            except ChainError:
                self._found = None  # the names are of another run, or nothing was sent yet
        return self._found


def _names_used(timeline: Timeline) -> Iterator[str]:
    """Yield the topics and services that callbacks take from or send to; not all that a robot sends."""
    received = {each.name for each in timeline.entities.values()}
    for name in timeline.names_sent:
        if name in received or any(each.sender for each in timeline.sent_on(name)[-1:]):
            yield name
