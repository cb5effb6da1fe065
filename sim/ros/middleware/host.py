"""The machine that nodes run on: its clock, network and trace, and the settings of the run.

An engine installs a host before the learner's program is imported. Without one, the first use creates a host
on wall time without a trace, so that the model also works as a plain library.
"""

import threading
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from itertools import count
from weakref import WeakMethod

from sim.clock import PacedClock, RunClock
from sim.probes.probe import Probe, SilentProbe
from sim.releases.profile import Profile
from sim.ros.middleware.callback_overrides import CallbackOverrides
from sim.ros.middleware.domain import domain_of_machine
from sim.ros.middleware.host_lock import lock_on
from sim.ros.middleware.network import Network

# Kept from before sim.clock.stdlib puts the virtual one in its place.
_RLock = threading.RLock

_OVERDUE = 40_000_000
"""Nanoseconds without a look at the waits on the real clock, after which a callback that ends has one."""


@dataclass(eq=False)
class Host:
    """The state that all contexts of this process share.

    ``lock`` guards all state of executors, groups and queues; it is never held during a wait or a callback.
    ``threads`` replaces the number of threads of every executor (None: the program's own), and ``overrides``
    has the other changes to the programs. ``default_domain`` is used outside programs. ``takes_signals``: the
    process runs only the program, so rclpy's signal handlers may be installed. ``profile``: the release.
    ``catches_up``: nobody asks for the waits whenever time passes, so they are recorded before they are over.
    """

    clock: RunClock
    probe: Probe
    threads: int | None = None
    overrides: CallbackOverrides | None = None
    lock: AbstractContextManager[bool] = field(init=False)
    catches_up: bool = field(init=False)
    default_domain: int = field(default_factory=domain_of_machine)
    takes_signals: bool = False
    profile: Profile = field(default_factory=Profile)
    _gids: Iterator[int] = field(default_factory=lambda: count(1))
    _networks: dict[int, Network] = field(default_factory=dict)
    _explainers: list[WeakMethod[Callable[[], int | None]]] = field(default_factory=list)

    _explained_at: int = 0

    def __post_init__(self) -> None:
        self.lock = lock_on(self.clock, self.probe.callback_here)
        self.catches_up = isinstance(self.clock, PacedClock)

    @property
    def network(self) -> Network:
        """The network of the default domain."""
        return self.network_of(self.default_domain)

    def network_of(self, domain: int) -> Network:
        """The network of a domain."""
        with self.lock:
            return self._networks.setdefault(domain, Network(self.clock))

    def new_gid(self) -> bytes:
        """16 bytes that identify a publisher, subscription or client; the same in every run."""
        return next(self._gids).to_bytes(16, "little")

    def explain_waits(self) -> int | None:
        """Record which callbacks wait now, and why; call this before time passes.

        Returns when the next timer is due: only then is known whether that timer has to wait.
        """
        with self.lock:
            self._explained_at = self.clock.now()
            alive = [each for reference in self._explainers if (each := reference()) is not None]
            dues = [explain() for explain in alive]
        return min((due for due in dues if due is not None), default=None)

    def catch_up(self) -> None:
        """Record who waits for a callback that is about to end, unless that was looked at just now."""
        if self.catches_up and self.clock.now() - self._explained_at >= _OVERDUE:
            self.explain_waits()

    def explain_waits_with(self, explain: Callable[[], int | None]) -> None:
        """Make ``explain_waits`` call a bound method, which is held weakly, with the lock held.

        ``explain`` records the waits that started or whose reason changed, and returns when the next timer is
        due.
        """
        with self.lock:
            self._explainers.append(WeakMethod(explain, self._explainers.remove))


_host: Host | None = None
_making = _RLock()


def current_host() -> Host:
    """The host of this process."""
    global _host  # noqa: PLW0603 -- a process has one host, as a machine has one network
    with _making:
        if _host is None:
            clock = PacedClock()
            _host = Host(clock=clock, probe=SilentProbe(clock), takes_signals=True)
        return _host


def install(host: Host) -> None:
    """Make ``host`` the host of this process; contexts made before keep theirs."""
    global _host  # noqa: PLW0603
    with _making:
        _host = host
