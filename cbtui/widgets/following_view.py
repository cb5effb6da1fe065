"""A view of lines that grows at its end and stays there unless the user scrolls away."""

from textual.geometry import Size
from textual.reactive import var

from cbtui.terminal.textual_internals import resize_content
from cbtui.widgets.inked_view import InkedView


class FollowingView(InkedView):
    """A view of lines that draws only visible ones; ``grow`` sets their number."""

    follows: var[bool] = var(True)
    """Whether it scrolls to its end when it grows."""

    def __init__(self, *, id: str | None = None) -> None:  # noqa: A002 Textual's name for it
        super().__init__(id=id)
        self._count = 0
        self._widest = 0
        self._fitting = False

    def below(self) -> int:
        """Rows that follow the last line."""
        return 0

    def grow(self, count: int, widest: int) -> None:
        """Show ``count`` lines, the longest of them ``widest`` columns wide."""
        self._count, self._widest = count, widest
        self._fit_size()
        self.refresh()

    def follow(self) -> None:
        """Scroll to the end, and follow it."""
        self.follows = True
        self._go_to_end()

    def stay(self) -> None:
        """Keep the visible lines in view."""
        self.follows = False

    def on_resize(self) -> None:
        """Stay at the end."""
        self._fit_size()

    def watch_scroll_y(self, old_value: float, new_value: float) -> None:
        """Follow the end if the user has scrolled down to it; a larger view only comes nearer to it."""
        super().watch_scroll_y(old_value, new_value)
        if not self._fitting:
            self.follows = new_value >= self.max_scroll_y and (self.follows or new_value > old_value)

    def _fit_size(self) -> None:
        self._fitting = True
        size = Size(self._widest, self._count + self.below())
        if size != self.virtual_size:
            resize_content(self, size)
        if self.follows:
            self._go_to_end()
        self._fitting = False

    def _go_to_end(self) -> None:
        self.scroll_to(y=self.max_scroll_y, animate=False, immediate=True, force=True)
