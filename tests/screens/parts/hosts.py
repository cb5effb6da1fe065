"""A screen as its parts see it, without a screen."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from textual.screen import Screen

from cbtui.looks.theme import Charset


@dataclass
class FakeHost:
    """Notes what parts ask of it; ``answers`` is what its questions come to."""

    charset: Charset = Charset.BRAILLE
    console: Any = None
    answers: list[object] = field(default_factory=list)
    asked: list[Screen[Any]] = field(default_factory=list)
    told: list[str] = field(default_factory=list)
    redrawn: int = 0

    def ask(self, question: Screen[Any], take: Callable[[Any], Any] | None) -> None:
        self.asked.append(question)
        if take is not None and self.answers:
            take(self.answers.pop(0))

    def tell(self, sentence: str | None, holds: Callable[[], bool] | None = None) -> None:
        if sentence is not None:
            self.told.append(sentence)

    def redraw(self) -> None:
        self.redrawn += 1

    def key(self, action: str) -> str:
        return f"<{action}>"
