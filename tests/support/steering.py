"""Runs a program on virtual time while somebody steers it from outside, as the console does."""

import threading
from collections.abc import Callable
from queue import Queue

from sim.clock import VirtualClock
from sim.engine.commands import PaceCommand, Resume, SetSpeed, Step
from sim.engine.time_control import VirtualControl
from sim.probes.probe import Probe
from sim.ros.middleware.host import Host
from sim.trace.events import AnyEvent, CommandGiven, TimeHalted, TimePassed
from tests.support.builder import ns
from tests.support.simulation import EndedClock, Program, Simulation, installed, no_thread_left

_PATIENCE = 60.0

Steering = Callable[["Helm"], object]


class Helm:
    """What somebody outside has at hand; ``over`` is set when the run is."""

    def __init__(self, clock: VirtualClock, take: Callable[[AnyEvent], None]) -> None:
        self.clock = clock
        self.over = threading.Event()
        self._take = take
        self._halts: Queue[TimeHalted] = Queue()
        self._control = VirtualControl(clock, self._record)
        self.record = self._control.record

    def _record(self, event: AnyEvent) -> None:
        self._take(event)
        if isinstance(event, TimeHalted):
            self._halts.put(event)

    def give(self, command: PaceCommand) -> None:
        """Give a command."""
        self._control.obey(command)

    def until_halted(self) -> TimeHalted:
        """Wait until time has come to stand again."""
        return self._halts.get(timeout=_PATIENCE)

    def step_to_the_end(self) -> None:
        """Take one step after another until the run is over; the last one finds nothing more."""
        while not self.over.is_set():
            self.give(Step())
            while not self.over.is_set() and self._halts.empty():
                self.over.wait(0.0001)
            if not self._halts.empty():
                self._halts.get()

    def let_go(self) -> None:
        """Let the run come to its end."""
        self.give(SetSpeed(None))
        self.give(Resume())


def steered(program: Program, steering: Steering, until: float, speed: float | None = None) -> list[AnyEvent]:
    """Run ``program`` for ``until`` seconds while ``steering`` runs on a thread outside; all events."""
    events: list[AnyEvent] = []
    trouble: list[BaseException] = []
    began = threading.Event()

    def run() -> None:
        clock = EndedClock(speed)
        helm = Helm(clock, events.append)
        simulation = Simulation(clock)
        simulation.host = Host(clock, Probe(clock, helm.record))
        clock.time.before_jump = simulation.host.explain_waits
        clock.call_at(ns(until), clock.end)
        outside = threading.Thread(target=lambda: _steer(steering, helm, began, trouble), daemon=True)
        outside.start()
        with installed(simulation.host):
            began.set()
            try:
                program(simulation)
            except KeyboardInterrupt:
                pass  # its time was up
            except BaseException as error:  # noqa: BLE001 -- it belongs to the test's own thread
                trouble.append(error)
            helm.over.set()
            seen = len(events)
            clock.wind_up()
            del events[seen:]
        outside.join()

    with no_thread_left():
        main = threading.Thread(target=run, name="MainThread", daemon=True)
        main.start()
        main.join(_PATIENCE)
        assert not main.is_alive(), "the run is stuck"
    if trouble:
        raise trouble[0]
    return events


def _steer(steering: Steering, helm: Helm, began: threading.Event, trouble: list[BaseException]) -> None:
    began.wait()
    try:
        steering(helm)
    except BaseException as error:  # noqa: BLE001 -- it belongs to the test's own thread
        trouble.append(error)
    finally:
        helm.let_go()


def without_commands(events: list[AnyEvent]) -> list[AnyEvent]:
    """What the program did, without what the person at the keyboard did to time, and what that showed."""
    return [event for event in events if not isinstance(event, (CommandGiven, TimeHalted, TimePassed))]
