"""A session that other terminals can give ``ros2`` lines to."""

from cbtui.engines.control_socket import ControlServer
from cbtui.engines.session import Deliver, Ended, Session
from sim.engine.commands import Command
from sim.engine.setup import RunSetup
from sim.trace.events import AnyEvent


class ListeningSession:
    """A ``Session`` beside which a control socket is open as long as it runs."""

    def __init__(self, setup: RunSetup, deliver: Deliver, ended: Ended) -> None:
        self._deliver = deliver
        self._session = Session(setup, self._take, ended)
        self._control = ControlServer(self._session.send)

    def start(self) -> str | None:
        """Start the engine, and listen; a sentence if it cannot be listened."""
        self._session.start()
        return self._control.start()

    def send(self, command: Command) -> None:
        """Tell the engine something; nothing happens if it has ended."""
        self._session.send(command)

    def stop(self) -> None:
        """Listen no more and end the engine. Safe to call twice."""
        self._control.stop()
        self._session.stop()

    def _take(self, events: list[AnyEvent]) -> None:
        self._control.take(events)
        self._deliver(events)
