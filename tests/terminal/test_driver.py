"""Signals that come while the main thread writes to the terminal."""

import io
import signal
from collections.abc import Callable, Iterator
from types import SimpleNamespace

import pytest
from textual.drivers._writer_thread import WriterThread

from cbtui.terminal.driver import TerminalDriver

HANDLERS = ("_sigcont_application", "_sigtstp_application")


@pytest.fixture
def kept_handlers() -> Iterator[None]:
    numbers = (signal.SIGCONT, signal.SIGTSTP)
    before = [signal.getsignal(number) for number in numbers]
    yield
    for number, handler in zip(numbers, before, strict=True):
        signal.signal(number, handler)


def writing_driver(later: list[Callable[[], None]]) -> TerminalDriver:
    """A driver with a queue of output, and an event loop that only takes calls."""
    driver = TerminalDriver.__new__(TerminalDriver)
    driver._writer_thread = WriterThread(io.StringIO())
    driver._loop = SimpleNamespace(call_soon_threadsafe=later.append)  # type: ignore[assignment]
    return driver


@pytest.mark.usefixtures("kept_handlers")
@pytest.mark.parametrize("handler", HANDLERS)
def test_a_signal_that_comes_while_output_is_queued_is_handled_afterwards(handler: str) -> None:
    later: list[Callable[[], None]] = []
    driver = writing_driver(later)
    assert driver._writer_thread is not None
    with driver._writer_thread._queue.mutex:
        getattr(driver, handler)(signal.SIGCONT, None)
    assert later == [getattr(driver, handler)]


@pytest.mark.usefixtures("kept_handlers")
def test_once_the_terminal_was_given_back_it_is_not_taken_again() -> None:
    driver = writing_driver([])
    signal.signal(signal.SIGCONT, signal.SIG_DFL)
    driver._sigcont_application()
    assert driver._writer_thread is not None
    assert driver._writer_thread._queue.empty()
