"""The lesson's text, in parts that are put there as they can be read."""

import asyncio
from collections.abc import Mapping

from textual.app import ComposeResult
from textual.containers import VerticalScroll

from cbtui.keys.keymap import keymap_of
from cbtui.keys.named_keys import with_keys_in_force
from cbtui.widgets.prose import Prose


class Guide(VerticalScroll):
    """Shows parts of a Markdown text, by name and in their order; links are not opened.

    The texts name keys as the registry has them; the person reads of their own.
    """

    def __init__(self, parts: Mapping[str, str], *, id: str | None = None) -> None:  # noqa: A002 Textual's name
        super().__init__(id=id)
        self._parts = dict(parts)
        self._one_at_a_time = asyncio.Lock()
        self._reading: tuple[Prose, int] | None = None

    def compose(self) -> ComposeResult:
        """Lay out the parts."""
        for name, text in self._parts.items():
            yield self._part(name, text)

    async def show(self, parts: Mapping[str, str]) -> None:
        """Show these parts, and leave alone what is as it was."""
        async with self._one_at_a_time:
            self._reading = self._reading or self._read_now(parts)
            before, self._parts = self._parts, dict(parts)
            for name in before.keys() - parts.keys():
                await self.query_one(f"#part-{name}").remove()
            for place, (name, text) in enumerate(parts.items()):
                if name not in before:
                    await self.mount(
                        self._part(name, text), before=place if place < len(self.children) else None
                    )
                elif text != before[name]:
                    self.query_one(f"#part-{name}", Prose).text = self._shown(text)
            self.call_after_refresh(self._keep_in_sight)

    def go_to(self, name: str) -> None:
        """Bring the beginning of a part to the top, if it is there and there is enough below it."""
        if name in self._parts:
            self._reading = (self.query_one(f"#part-{name}", Prose), 0)
            self.call_after_refresh(self._keep_in_sight)

    def _read_now(self, parts: Mapping[str, str]) -> tuple[Prose, int] | None:
        """Return which of the parts that stay is at the top, and how many of its rows are above it."""
        top = self.scroll_offset.y
        staying = (self.query_one(f"#part-{name}", Prose) for name in self._parts if name in parts)
        part = next((part for part in staying if part.virtual_region.bottom > top), None)
        return None if top == 0 or part is None else (part, max(0, top - part.virtual_region.y))

    def _keep_in_sight(self) -> None:
        """Let a text that is or was to be read be where it was, whatever came and went above it."""
        if self._reading is not None:
            part, above = self._reading
            self._reading = None
            self.scroll_to(y=part.virtual_region.y + above, animate=False, immediate=True)

    def _part(self, name: str, text: str) -> Prose:
        return Prose(self._shown(text), id=f"part-{name}")

    def _shown(self, text: str) -> str:
        return with_keys_in_force(text, keymap_of(self.app))
