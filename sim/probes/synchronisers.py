"""Judges synchronisers of ``message_filters``: they say nothing of messages that never come together."""

from collections import deque
from collections.abc import Callable, Sequence
from typing import Any

from sim.probes.probe import Probe
from sim.quantities.nanoseconds import SECOND
from sim.trace.events import AnyEvent, SynchroniserJudged

MANY = 20
"""Messages of one topic after which a synchroniser is judged, if all others have brought ``FEW``."""
FEW = 5
PATIENCE = 5 * SECOND
"""How long one is not judged of which a topic has brought fewer, after the last topic to bring any."""
_KEPT = 200


class SynchroniserFollower:
    """Follows one synchroniser, and records when it has handed on nothing though it should have.

    ``topics`` are those of its filters, "" for one without a topic.
    """

    def __init__(
        self,
        probe: Probe,
        now: Callable[[], int],
        record: Callable[[AnyEvent], None],
        synchroniser: Any,
        topics: Sequence[str],
    ) -> None:
        self._probe = probe
        self._now = now
        self._record = record
        self._synchroniser = synchroniser
        self._topics = tuple(topics)
        self._made_at = probe.place_of_call()
        self._counts = [0] * len(topics)
        self._stamps = [deque[int](maxlen=_KEPT) for _ in topics]
        self._since = 0
        self._told: set[bool] = set()
        self._done = False

    def got(self, index: int, stamp: int) -> None:
        """Judge what has come before this message, and remember it."""
        if self._done:
            return
        few = min(self._counts) < FEW
        if max(self._counts) >= MANY and not (few and self._now() < self._since + PATIENCE):
            has_all = min(self._counts) > 0
            if has_all not in self._told:
                self._told.add(has_all)
                self._judge(matched=False)
        if not self._counts[index]:
            self._since = self._now()
        self._counts[index] += 1
        self._stamps[index].append(stamp)

    def handed_on(self) -> None:
        """Follow no more; if it was said to hand on nothing, record that it does."""
        if not self._done and self._told:
            self._judge(matched=True)
        self._done = True

    def _judge(self, *, matched: bool) -> None:
        distances = sorted(self._distances())
        slop = getattr(self._synchroniser, "slop", None)
        self._record(
            SynchroniserJudged(
                self._now(),
                self._probe.callback_here(),
                self._made_at,
                self._topics,
                tuple(self._counts),
                tuple(each[-1] if each else 0 for each in self._stamps),
                0 if slop is None else slop.nanoseconds,
                distances[0] if distances else 0,
                distances[len(distances) * 3 // 4] if distances else 0,
                matched,
            )
        )

    def _distances(self) -> list[int]:
        """How far each message of the rarest topic is from the nearest of the others, by their stamps."""
        rarest = min(self._stamps, key=len)
        others = [each for each in self._stamps if each is not rarest]
        if not rarest:
            return []
        return [
            max((min(abs(each - stamp) for each in other) for other in others), default=0) for stamp in rarest
        ]
