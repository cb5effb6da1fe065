"""A session that accepts ``ros2`` lines from other terminals."""

from cbtui.engines.control_socket import ControlServer
from cbtui.engines.session import Deliver, Ended, ProcessSession
from sim.engine.commands import Command
from sim.engine.setup import RunSetup
from sim.trace.events import AnyEvent


class ListeningSession:
    """A ``ProcessSession`` with a control socket that is open while it runs."""

    def __init__(self, setup: RunSetup, deliver: Deliver, ended: Ended) -> None:
        self._deliver = deliver
        self._ended = ended
        self._session = ProcessSession(setup, self._take, self._end)
        self._control = ControlServer(self._session.send, setup.title)

    def start(self) -> str | None:
        """Start the engine and listen; returns a sentence if the socket cannot be opened."""
        self._session.start()
        return self._control.start()

    def send(self, command: Command) -> None:
        """Send a command to the engine; ignored once it has ended."""
        self._session.send(command)

    def stop(self) -> None:
        """Stop listening and end the engine. Idempotent."""
        self._control.stop()
        self._session.stop()

    def _take(self, events: list[AnyEvent]) -> None:
        self._control.take(events)
        self._deliver(events)

    def _end(self, trouble: str | None) -> None:
        self._control.over()
        self._ended(trouble)
