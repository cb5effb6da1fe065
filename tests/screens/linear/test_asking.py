"""What is told of a chain of messages in lines."""

import contextlib
from typing import cast

from cbtui.runs.live.live_run import ShownRun
from cbtui.screens.linear.asking import ChainPrompt
from cbtui.screens.linear.dialogue import Dialogue, LineHost
from cbtui.screens.parts.navigation import TimeNavigation
from cbtui.screens.parts.runs import RunController
from tests.screens.parts.test_chain_path import Runs, line


class Host:
    """Answers every question alike."""

    def __init__(self, answer: str) -> None:
        self.answer = answer
        self.told: list[str] = []

    def tell(self, sentence: str) -> None:
        self.told.append(sentence)

    def ask(self, dialogue: Dialogue) -> None:
        next(dialogue)
        with contextlib.suppress(StopIteration):
            dialogue.send(self.answer)


def told(answer: str, at: int | None = None) -> list[str]:
    timeline = line().timeline()
    navigation = TimeNavigation(lambda: [timeline], lambda: timeline.end, lambda: None)
    if at is not None:
        navigation.seek(at)
    host = Host(answer)
    runs = cast("RunController[ShownRun]", Runs(timeline))
    ChainPrompt(cast("LineHost", host), runs, navigation).action_chain()
    return host.told


def test_a_chain_is_told_step_by_step() -> None:
    lines = told("raw:drive")
    assert lines[0] == "The last way from /raw to /drive began at 2.000 s and took 420 ms:"
    assert "300 ms: clean waits, group B held by slow" in lines
    assert any(each.startswith("The slowest way from /raw to /drive began at 2.000 s") for each in lines)


def test_before_a_message_has_gone_all_the_way_that_is_told() -> None:
    assert told("raw:drive", at=500_000_000) == ["Nothing has gone all the way from /raw to /drive yet."]


def test_nothing_typed_asks_nothing() -> None:
    assert told("") == []
