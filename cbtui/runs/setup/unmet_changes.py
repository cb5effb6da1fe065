"""Which changes of groups and periods no callback of a run has met so far."""

import linecache
import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from difflib import get_close_matches
from itertools import islice

from cbtui.runs.setup.changeable import place_of, programs_own
from cbtui.runs.setup.changes import CallbackPlace
from cbtui.text.callback_names import short_name
from sim.engine.setup import RunSetup
from sim.trace.events import EntityKind
from sim.trace.timeline import Timeline


@dataclass(frozen=True, slots=True)
class UnmetChange:
    """A change for a callback of a node ("" for any) that the run lacks; ``is_timer`` if a period changes.

    ``is_wrong``: no file of the programs mentions its callback, or its node.
    """

    place: CallbackPlace
    is_timer: bool
    is_wrong: bool

    def sentence(self, quote: str = "") -> str:
        """Say what is not there, with names in quotes."""
        node, callback = self.place
        where = f" in {quote}{node}{quote}" if node else ""
        kind = "timer callback" if self.is_timer else "callback"
        return f"no {kind} is named {quote}{callback}{quote}{where} so far"


@dataclass
class UnmetChanges:
    """Compares the changes of a set-up with the callbacks of its run; of these it looks at each once."""

    setup: RunSetup
    _seen: int = field(default=0, init=False)
    _callbacks: set[CallbackPlace] = field(default_factory=set, init=False)
    _timers: set[CallbackPlace] = field(default_factory=set, init=False)
    _files: set[str] = field(default_factory=set, init=False)
    _misspelt: set[str] = field(default_factory=set, init=False)
    """Names in changes that are nearly those of callbacks."""

    def now(self, timeline: Timeline) -> list[UnmetChange]:
        """Return the changes that are unmet, but for those whose callback is probably still to be made.

        What a launch file starts is not known before it runs: there, another callback has nearly that name.
        """
        changed = [((each.node, each.callback), False) for each in self.setup.groups]
        changed += [((each.node, each.callback), True) for each in self.setup.periods]
        self._look(timeline, {callback for (_, callback), _ in changed})
        missing = (each for each in changed if each[0] not in (self._timers if each[1] else self._callbacks))
        return [unmet for place, is_timer in missing for unmet in self._unmet(place, is_timer, timeline)]

    def _look(self, timeline: Timeline, changed: set[str]) -> None:
        new: set[str] = set()
        for entity in islice(timeline.entities.values(), self._seen, None) if changed else ():
            self._files |= {entity.file, entity.made_at[0]}
            if programs_own(entity):
                node, name = place_of(entity, timeline)
                names = {name, short_name(name)}
                places = {(at, each) for at in (node, "") for each in names}
                new |= names
                self._callbacks |= places
                if entity.kind is EntityKind.TIMER:
                    self._timers |= places
        self._seen = len(timeline.entities)
        if self._is_launched:
            self._misspelt |= {each for each in changed if get_close_matches(each, new, 1, 0.75)}

    @property
    def _is_launched(self) -> bool:
        return any(each.is_launch_file for each in self.setup.programs)

    def _unmet(self, place: CallbackPlace, is_timer: bool, timeline: Timeline) -> Iterator[UnmetChange]:
        node, callback = place
        is_here, has_node = ("", callback) in self._callbacks, not node or node in timeline.nodes.values()
        if self._is_launched:
            is_wrong = not is_here and callback in self._misspelt
        else:
            is_wrong = not (is_here or self._is_mentioned(callback)) or not (
                has_node or self._is_mentioned(node)
            )
        if is_wrong or (is_here and has_node):
            yield UnmetChange(place, is_timer, is_wrong)

    def _is_mentioned(self, name: str) -> bool:
        """Whether what has a name may still be made; a number at its end may be counted."""
        last = name.rpartition("/")[2].rstrip("0123456789")
        ends = "" if last and name[-1].isdigit() else r"(_callback)?\b"
        word = re.compile(rf"\b{re.escape(last)}{ends}")
        programs, texts = self.setup.programs, self.setup.texts
        files = {*(each.path for each in programs), *self._files}
        told = [texts.get(file) or "".join(linecache.getlines(file)) for file in files]
        told += [argument for each in programs for argument in each.arguments]
        return any(word.search(text) for text in told)
