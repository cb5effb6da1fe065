"""The machine that nodes run on: its clock, network and trace, and the settings of the run.

An engine installs a host before the learner's program is imported. Without one, the first use creates a host
on wall time without a trace, so that the model also works as a plain library.
"""

import threading
from collections.abc import Iterator
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from itertools import count
from typing import Protocol
from weakref import ref

from sim.clock import PacedClock, RunClock
from sim.probes.probe import Probe, SilentProbe
from sim.releases.profile import Profile
from sim.ros.middleware.callback_overrides import CallbackOverrides
from sim.ros.middleware.domain import domain_of_machine
from sim.ros.middleware.host_lock import lock_on
from sim.ros.middleware.network import Network

# Kept from before sim.clock.stdlib puts the virtual one in its place.
_RLock = threading.RLock


@dataclass(eq=False)
class Host:
    """The state that all contexts of this process share.

    ``lock`` guards all state of executors, groups and queues; it is never held during a wait or a callback.
    ``threads`` replaces the number of threads of every executor (None: the program's own), ``overrides`` has
    the other changes to the programs. ``default_domain`` is used outside programs. ``takes_signals``: the
    whole process is the program's, so rclpy's signal handlers may be installed. ``profile``: what it is like.
    """

    clock: RunClock
    probe: Probe
    threads: int | None = None
    overrides: CallbackOverrides | None = None
    lock: AbstractContextManager[bool] = field(init=False)
    default_domain: int = field(default_factory=domain_of_machine)
    takes_signals: bool = False
    profile: Profile = field(default_factory=Profile)
    _gids: Iterator[int] = field(default_factory=lambda: count(1))
    _networks: dict[int, Network] = field(default_factory=dict)
    _waiters: "list[ref[WaitsExplained]]" = field(default_factory=list)

    def __post_init__(self) -> None:
        self.lock = lock_on(self.clock, self.probe.callback_here)

    @property
    def network(self) -> Network:
        """The network of the default domain."""
        return self.network_of(self.default_domain)

    def network_of(self, domain: int) -> Network:
        """The network of a domain."""
        with self.lock:
            return self._networks.setdefault(domain, Network())

    def new_gid(self) -> bytes:
        """16 bytes that identify a publisher, subscription or client; the same in every run."""
        return next(self._gids).to_bytes(16, "little")

    def explain_waits(self) -> int | None:
        """Record which callbacks wait now, and why; call it before time passes.

        Returns when the next timer is due: whether it has to wait is known only then.
        """
        with self.lock:
            waiters = [each for reference in self._waiters if (each := reference()) is not None]
            dues = [waiter.explain_waits() for waiter in waiters]
        return min((due for due in dues if due is not None), default=None)

    def explain_waits_of(self, waiter: "WaitsExplained") -> None:
        """Include ``waiter`` from now on, as long as it lives."""
        with self.lock:
            self._waiters.append(ref(waiter, self._waiters.remove))


class WaitsExplained(Protocol):
    """Something that can explain why its callbacks wait."""

    def explain_waits(self) -> int | None:
        """Record waits that started or whose reason changed; return when the next timer is due.

        Called with the host's lock held.
        """


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
