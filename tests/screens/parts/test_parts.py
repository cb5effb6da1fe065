"""A screen's actions are those of its parts; what no part does, the screen does not have."""

from pathlib import Path

from textual.screen import Screen

from cbtui.keys.action import Scope, method_of
from cbtui.keys.actions import ACTIONS
from cbtui.looks.theme import Charset
from cbtui.runs.compared_runs import ComparedSide
from cbtui.runs.setup.shown_program import of_file, of_lesson
from cbtui.screens.compare import CompareScreen
from cbtui.screens.exercise import ExerciseScreen
from cbtui.screens.lesson import LessonScreen
from cbtui.screens.parts.part import ScreenPart, ScreenParts
from cbtui.screens.replay import ReplayScreen
from lessons.catalogue import find, lessons
from sim.recording import RecordingMetadata, read
from sim.trace.timeline import Timeline
from tests.recording.files import write
from tests.support.fake_session import FakeEngines
from tests.support.runs import shared_group_run

WITH_AN_ENGINE = {"run_again", "start_over", "record"}
WITH_A_PERSON = {
    "call_service",
    "call_service_off",
    "no_call_service",
    "no_call_service_off",
    "prompt",
    "prompt_here",
    "type",
    "reset_world",
    "threads",
    "group",
    "set_up",
    "take_over",
}
CHOSEN = {"undo"}
TAUGHT = {"predict", "explain", "exercise"}
REFUSED = {"no_exercise", "no_hint", "no_solution", "no_compare", "no_take_over", "no_use"}


class Lamp(ScreenPart):
    """A part with a state and an action of its own."""

    lit = False

    def offers(self, action: str, parameters: tuple[object, ...]) -> bool:
        return not self.lit

    def action_pause(self) -> None:
        self.lit = True


def test_an_action_is_done_and_offered_by_the_part_that_has_it() -> None:
    screen: Screen[None] = Screen()
    lamp = Lamp()
    parts = ScreenParts(screen, Scope.LESSON, lamp)
    assert parts.offer("pause", ())
    screen.action_pause()  # type: ignore[attr-defined]
    assert lamp.lit
    assert not parts.offer("pause", ())


def test_actions_of_the_scope_that_no_part_has_are_not_the_screens() -> None:
    parts = ScreenParts(Screen(), Scope.LESSON, Lamp())
    assert not parts.has("record")
    assert not parts.offer("record", ())
    assert parts.offer("command_palette", ())


def lesson() -> LessonScreen:
    engines = FakeEngines([], 0)
    return LessonScreen(of_lesson(find("split-groups"), lessons()), engines, Charset.BRAILLE)


def exercise() -> ExerciseScreen:
    chosen = find("split-groups")
    assert chosen.starter_path is not None
    return ExerciseScreen(chosen, lessons(), chosen.starter_path, FakeEngines([], 0), Charset.BRAILLE)


def replay(folder: Path) -> ReplayScreen:
    path = folder / "run.mcap"
    write(path, shared_group_run().events, RecordingMetadata(title="x", clock="virtual"))
    return ReplayScreen(read(path), Charset.BRAILLE)


def every(scope: Scope) -> set[str]:
    return {method_of(action)[0] for action in ACTIONS if action.scope is scope}


def actions_of(screen: Screen[None], scope: Scope = Scope.LESSON) -> set[str]:
    return {name for name in every(scope) if hasattr(screen, f"action_{name}")}


def test_each_screen_has_the_actions_that_make_sense_for_what_it_shows(tmp_path: Path) -> None:
    of_a_lesson, of_an_exercise = actions_of(lesson()), actions_of(exercise())
    assert every(Scope.LESSON) - of_a_lesson == {"lesson", "watch"} | CHOSEN
    assert every(Scope.LESSON) - of_an_exercise == WITH_A_PERSON | TAUGHT | (REFUSED - {"no_use"}) | CHOSEN
    missing = every(Scope.LESSON) - actions_of(replay(tmp_path))
    assert missing == WITH_AN_ENGINE | WITH_A_PERSON | TAUGHT | (REFUSED - {"no_use"}) | CHOSEN | {
        "no_time",
        "compare",
        "hint",
        "solution",
        "next_lesson",
        "lesson",
        "watch",
    }


def test_nothing_is_taught_about_a_file_of_ones_own(tmp_path: Path) -> None:
    screen = LessonScreen(of_file(tmp_path / "node.py", [], "real"), FakeEngines([], 0), Charset.BRAILLE)
    assert not actions_of(screen) & (TAUGHT | {"hint", "solution", "next_lesson"})


def test_a_comparison_has_all_actions_of_its_scope() -> None:
    sides = ComparedSide("one", Timeline()), ComparedSide("other", Timeline())
    assert actions_of(CompareScreen(*sides, Charset.BRAILLE), Scope.COMPARE) == every(Scope.COMPARE)
