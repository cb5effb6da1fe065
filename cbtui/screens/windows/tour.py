"""The tour: a minute over a lesson that tells what each part of the screen is for."""

from collections.abc import Callable
from math import ceil
from typing import NamedTuple

from textual.app import ComposeResult
from textual.events import Click, Key
from textual.widgets import Static

from cbtui.keys.action import Scope
from cbtui.keys.keymap import keymap_of
from cbtui.keys.named_keys import with_keys_in_force
from cbtui.looks.theme import Charset
from cbtui.screens.windows.window import WindowScreen
from cbtui.widgets.key_bar import KeyBar
from cbtui.widgets.prose import Prose

_LEAST = 6.0
"""The seconds that a stop stays at least."""
_WORDS_A_SECOND = 3
"""How quickly somebody reads who looks at the place, too."""
_TICK = 0.5
LINE = "the line above the keys"


class TourStop(NamedTuple):
    """A part of the screen, ``lanes``, ``LINE`` or a pane, and what it is for."""

    place: str
    text: str

    @property
    def seconds(self) -> float:
        """How long it stays unless a key goes on."""
        return max(_LEAST, len(self.text.split()) / _WORDS_A_SECOND)


STOPS = (
    TourStop(
        "guide", "A lesson is an ordinary ROS 2 node. It starts now, runs slowly, and this is its guide."
    ),
    TourStop(
        "lanes",
        "Time goes from left to right. The top lane is a thread: each stroke is a call of a callback.",
    ),
    TourStop("lanes", "Below are the callback groups. A letter and a colour belong to each, in every pane."),
    TourStop(
        "lanes",
        "Nothing waits yet. When a callback has to, its lane is hatched, ╱╱╱╱, and says what it waits for.",
    ),
    TourStop("code", "The code, as it would run on a robot. The mark at its side shows what runs."),
    TourStop(
        "factory", "The same as a factory: belts bring messages, areas are groups, workers are threads."
    ),
    TourStop("robot", "What the node does to its robot, and what the node knows of the world."),
    TourStop("log", "What the node logs. `space` pauses, `[` looks back: every pane shows that moment."),
    TourStop(LINE, "This line says who waits for whom. `d` tells what went wrong, and the cure."),
    TourStop(
        "guide",
        "So a lesson goes: predict, run, `a` explains, `e` is its exercise if it has one. `?` has every key.",
    ),
)


class TourScreen(WindowScreen[None]):
    """Shows the stops one after the other, by itself or by keys; ``show`` brings a place to the fore.

    Any other key, or a click, leaves it.
    """

    SCOPE = Scope.TOUR
    HAS_HELP = False

    def __init__(self, show: Callable[[str], None], charset: Charset) -> None:
        super().__init__(charset)
        self._show = show
        self._place, self._left = 0, 0.0

    def content(self) -> ComposeResult:
        """Lay out the text, and the time that is left for the stop."""
        yield Prose("")
        yield Static(id="left")

    def on_mount(self) -> None:
        """Begin."""
        self._go_to(0)
        self.set_interval(_TICK, self._wait)

    def on_key(self, event: Key) -> None:
        """Leave, unless the key is one of the tour's."""
        if event.key not in self.active_bindings:
            event.stop()
            self.dismiss(None)

    def on_click(self, event: Click) -> None:
        """Leave, unless a key of the tour is clicked."""
        if not isinstance(event.widget, KeyBar):
            self.dismiss(None)

    def action_next(self) -> None:
        """Go to the next stop, from the last on with the lesson."""
        if self._place + 1 < len(STOPS):
            self._go_to(self._place + 1)
        else:
            self.dismiss(None)

    def action_previous(self) -> None:
        """Go back to the stop before."""
        self._go_to(max(0, self._place - 1))

    def _wait(self) -> None:
        self._left -= _TICK
        if self._left > 0:
            self._show_left()
        else:
            self.action_next()

    def _go_to(self, place: int) -> None:
        stop = STOPS[place]
        self._place, self._left = place, stop.seconds
        self.query_one(".window").border_title = f"Tour {place + 1}/{len(STOPS)}: {stop.place}"
        self.query_one(Prose).text = with_keys_in_force(stop.text, keymap_of(self.app))
        self._show_left()
        self.set_class(stop.place != "lanes", "-over-lanes")
        self._show(stop.place)

    def _show_left(self) -> None:
        turns = "goes on" if self._place + 1 < len(STOPS) else "ends"
        squares = "▪" * round(self._left / _TICK)
        self.query_one("#left", Static).update(f"{turns} by itself in {ceil(self._left)} s  {squares}")
