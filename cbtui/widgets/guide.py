"""A lesson's text in sections, which are added as they are unlocked."""

import asyncio
from collections.abc import Mapping

from textual.app import ComposeResult
from textual.containers import VerticalScroll

from cbtui.keys.keymap import keymap_of
from cbtui.keys.named_keys import with_keys_in_force
from cbtui.widgets.prose import Prose


class Guide(VerticalScroll):
    """Shows named sections of a Markdown text in their order; links are not opened.

    The registry's keys in the texts are replaced by those in force.
    """

    def __init__(self, parts: Mapping[str, str], *, id: str | None = None) -> None:  # noqa: A002 Textual's name
        super().__init__(id=id)
        self._parts = dict(parts)
        self._one_at_a_time = asyncio.Lock()
        self._reading: tuple[Prose, int] | None = None
        self._width = 0
        self._top: tuple[Prose, int] | None = None
        """The topmost section in sight, and how many of its letters are scrolled out."""

    def compose(self) -> ComposeResult:
        """Lay out the parts."""
        for name, text in self._parts.items():
            yield self._part(name, text)

    async def show(self, parts: Mapping[str, str]) -> None:
        """Show these sections; unchanged ones are not touched."""
        async with self._one_at_a_time:
            self._reading = self._reading or self._read_now(parts)
            before, self._parts = self._parts, dict(parts)
            for name in before.keys() - parts.keys():
                await self.query(f"#part-{name}").remove()
            for place, (name, text) in enumerate(parts.items()):
                if name not in before:
                    await self.mount(
                        self._part(name, text), before=place if place < len(self.children) else None
                    )
                elif text != before[name]:
                    for part in self._parts_named(name):
                        part.text = self._shown(text)
            self.call_after_refresh(self._keep_in_sight)

    def go_to(self, name: str) -> None:
        """Scroll a section to the top, if it exists."""
        for part in self._parts_named(name):
            self._reading = (part, 0)
            self.call_after_refresh(self._keep_in_sight)

    def is_past(self, name: str) -> bool:
        """Whether the reader has scrolled on from the top of a section."""
        places = (part.virtual_region for part in self._parts_named(name))
        return any(place and place.y < self.scroll_offset.y for place in places)

    def _read_now(self, parts: Mapping[str, str]) -> tuple[Prose, int] | None:
        """Return the topmost section that stays, and how many of its rows are scrolled out."""
        top = self.scroll_offset.y
        staying = (part for name in self._parts if name in parts for part in self._parts_named(name))
        part = next((part for part in staying if part.virtual_region.bottom > top), None)
        return None if top == 0 or part is None else (part, max(0, top - part.virtual_region.y))

    def on_show(self) -> None:
        """Scroll to the section that was asked for while the guide was hidden."""
        self._keep_in_sight()

    def watch_scroll_y(self, old_value: float, new_value: float) -> None:
        """Remember the text at the top, unless it is a new width that moves it."""
        super().watch_scroll_y(old_value, new_value)
        if self.size.width == self._width:
            read = self._read_now(self._parts)
            self._top = read and (read[0], read[0].letters_above(read[1]))

    def on_resize(self) -> None:
        """Keep the text that was at the top there."""
        changed, self._width = self.size.width != self._width, self.size.width
        if changed and self._top is not None:
            self.call_after_refresh(self._put_on_top, *self._top)

    def _put_on_top(self, part: Prose, letter: int) -> None:
        if part.is_attached:
            self._reading = self._reading or (part, part.row_of(letter))
            self._keep_in_sight()

    def _keep_in_sight(self) -> None:
        """Restore the scroll position of the text that was being read, once it has a place."""
        if self._reading is not None and self._reading[0].virtual_region:
            part, above = self._reading
            self._reading = None
            self.scroll_to(y=part.virtual_region.y + above, animate=False, immediate=True)

    def _parts_named(self, name: str) -> list[Prose]:
        """Return the section of this name; none if there is none, as while the console ends."""
        return [*self.query(f"#part-{name}").results(Prose)]

    def _part(self, name: str, text: str) -> Prose:
        return Prose(self._shown(text), id=f"part-{name}")

    def _shown(self, text: str) -> str:
        return with_keys_in_force(text, keymap_of(self.app))
