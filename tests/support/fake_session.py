"""A session without an engine: it plays recorded events as far as a test says."""

from collections.abc import Sequence

from cbtui.engines.session import Deliver, Ended
from sim.engine.commands import Command
from sim.engine.setup import RunSetup
from sim.trace.events import AnyEvent


class FakeSession:
    """An ``EngineSession`` without a process; everything happens on the thread of the caller."""

    def __init__(
        self, setup: RunSetup, deliver: Deliver, ended: Ended, events: Sequence[AnyEvent], until: int
    ) -> None:
        self.setup = setup
        self.commands: list[Command] = []
        self.started = self.stopped = False
        self._deliver = deliver
        self._ended = ended
        self._events = list(events)
        self._until = until

    def start(self) -> None:
        """Deliver what is to be there from the start."""
        self.play(self._until)
        self.started = True

    def play(self, until: int) -> None:
        """Deliver the events up to a time in nanoseconds, that included."""
        batch = [event for event in self._events if event.t <= until]
        self._events = self._events[len(batch) :]
        if batch:
            self._deliver(batch)

    def end(self, loss: str | None = None) -> None:
        """Let the engine end as it should, or be lost."""
        self._ended(loss)

    def send(self, command: Command) -> None:
        """Remember a command."""
        self.commands.append(command)

    def stop(self) -> None:
        """Remember that the session was ended."""
        self.stopped = True


class FakeEngines:
    """Opens fake sessions that all play the same events, and keeps them."""

    def __init__(self, events: Sequence[AnyEvent], until: int) -> None:
        self.sessions: list[FakeSession] = []
        self._events = events
        self._until = until

    def __call__(self, setup: RunSetup, deliver: Deliver, ended: Ended) -> FakeSession:
        """Open a session."""
        self.sessions.append(FakeSession(setup, deliver, ended, self._events, self._until))
        return self.sessions[-1]

    @property
    def latest(self) -> FakeSession:
        """The session that was opened last."""
        return self.sessions[-1]
