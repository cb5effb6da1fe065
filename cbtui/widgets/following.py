"""A view of lines that grows at its end and stays there unless the person scrolls away."""

from textual.geometry import Size

from cbtui.widgets.inked import Inked


class Following(Inked):
    """Draws its lines itself, those in view only. ``grow`` tells it of more lines."""

    def __init__(self, *, id: str | None = None) -> None:  # noqa: A002 Textual's name for it
        super().__init__(id=id)
        self._count = 0
        self._widest = 0
        self._follows = True

    def beside(self) -> int:
        """Columns that every line takes beside its text."""
        return 0

    def grow(self, count: int, widest: int) -> None:
        """Show ``count`` lines, the longest of them ``widest`` columns wide."""
        self._count, self._widest = count, widest
        self._fit_size()
        self.refresh()

    def on_resize(self) -> None:
        """Stay at the end."""
        self._fit_size()

    def watch_scroll_y(self, old_value: float, new_value: float) -> None:
        """Follow the end if that is where the person has scrolled to."""
        super().watch_scroll_y(old_value, new_value)
        self._follows = new_value >= self.max_scroll_y

    def _fit_size(self) -> None:
        follows = self._follows
        size = Size(self._widest + self.beside(), self._count)
        if size != self.virtual_size:
            # Assigning it would lay out the whole screen anew for every line.
            self.set_reactive(Following.virtual_size, size)
            self._scroll_update(size)
        if follows:
            self.scroll_to(y=self.max_scroll_y, animate=False, immediate=True, force=True)
            self._follows = True
