"""The console for screen readers: what is typed and what is said, line by line."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest

from cbtui.keys.keymap import Keymap
from cbtui.runs.judged.cures import Verdict
from cbtui.runs.setup.changes import Changes
from cbtui.runs.setup.shown_program import of_lesson, of_puzzle
from cbtui.screens.linear.choosing import ChoosingConsole
from cbtui.screens.linear.console import LinearConsole, LineTerminal
from cbtui.screens.linear.exercise import told_difference
from cbtui.screens.linear.lesson import LessonConsole
from cbtui.screens.linear.replay import ReplayConsole
from cbtui.screens.parts.cures import CureTrial
from lessons.catalogue import find, lessons
from lessons.progress import Progress
from sim.engine.commands import CallService, Pause, Resume, RunLine, RunUntil, Step, TerminalInput
from sim.recording import RecordingMetadata, read
from sim.trace.events import AnyEvent, KeyboardAsked, Reading
from tests.recording.files import write
from tests.support.asking import PUZZLE, Asking
from tests.support.builder import ns
from tests.support.console import observed
from tests.support.fake_session import FakeEngines
from tests.support.runs import shared_group_run

EVENTS = shared_group_run().events
EXERCISE = "split-groups"
"""A lesson that has one."""


class Typist:
    """Types what a script says, several lines between ``|``, as soon as the console tells what it awaits.

    ``make`` makes the console.
    """

    def __init__(
        self,
        script: list[tuple[str, str]],
        make: Callable[[LineTerminal], LinearConsole[Any]],
        keys: Keymap | None = None,
    ) -> None:
        self.lines: list[str] = []
        self._script = script
        self.console = make(LineTerminal(self, self._hear, keys or Keymap()))

    def run(self) -> list[str]:
        """Run the console; returns what it said."""
        self.console.run()
        assert not self._script, self.lines
        return self.lines

    def take_lines(self, *, wanted: bool) -> None:
        """There is no terminal."""

    def _hear(self, line: str) -> None:
        self.lines.append(line)
        if self._script and self._script[0][0] in line:
            for typed in self._script.pop(0)[1].split("|"):
                self.console.typed(typed)


class Lesson(Typist):
    """Types at the console of a lesson."""

    def __init__(
        self,
        script: list[tuple[str, str]],
        keys: Keymap | None = None,
        more: Sequence[AnyEvent] = (),
        lesson: str = "shared-group",
        *,
        with_exercise: bool = False,
    ) -> None:
        self.engines = FakeEngines([*EVENTS, *more], ns(12.9))
        subject = of_lesson(find(lesson), lessons())
        super().__init__(
            script,
            lambda terminal: LessonConsole(
                terminal, subject, Changes(), self.engines, observed(EVENTS), with_exercise
            ),
            keys,
        )


def predict(lesson: str = "shared-group") -> None:
    """Let the lesson's predictions have been made before."""
    for place, prediction in enumerate(find(lesson).predictions):
        Progress().answer(lesson, place, prediction.right)


def test_a_lesson_is_predicted_watched_and_explained_in_lines() -> None:
    questions = len(find("shared-group").predictions)
    wrong = [("Your answer is final", "9"), ("There is no answer 9", "2")]
    more = [("Your answer is final", "1")] * (questions - 1)
    lines = Lesson([*wrong, *more, ("problem: ", "a"), ("Checked against", "q")]).run()
    assert lines[0] == "One shared group"
    assert Progress().of("shared-group").answers == (1, *[0] * (questions - 1))
    assert Progress().of("shared-group").explained
    assert any(line.startswith("What the run showed: You got") for line in lines)
    assert _told_once("Watch", lines) < next(at for at, line in enumerate(lines) if "The run begins" in line)
    assert not any(sign in line for line in lines for sign in "│─█▸✓→●")


def _told_once(line: str, lines: list[str]) -> int:
    assert lines.count(line) == 1
    return lines.index(line)


def test_what_to_watch_for_gives_no_answer_away_before_it_is_given() -> None:
    lines = Lesson(
        [
            ("Your answer is final", ""),
            ("problem: ", "a"),
            ("Your answer is final", ""),
            ("Checked against", "q"),
        ]
    ).run()
    asked = max(at for at, line in enumerate(lines) if "Your answer is final" in line)
    assert asked < _told_once("Watch", lines) < _told_once("Why", lines)


def test_keys_labels_and_lines_are_carried_out() -> None:
    predict()
    script = [
        ("The run begins", "s"),
        ("problem: ", "pause"),
        ("time stands still", " "),
        ("time goes on", "ros2 topic list|q"),
    ]
    typist = Lesson(script)
    typist.run()
    commands = typist.engines.latest.commands
    assert [type(each) for each in commands] == [CallService, Pause, Resume, RunLine]
    assert typist.engines.latest.stopped


def test_what_cannot_be_done_now_is_said_and_help_tells_the_keys_in_force() -> None:
    predict()
    script = [
        ("The run begins", "."),
        ("step is not possible", "nonsense"),
        ("there is no key", "?"),
        ("b: ", "b"),
    ]
    lines = Lesson(script, Keymap({"lesson.leave": ("b",)})).run()
    assert any(line.startswith("comma: look back: ") for line in lines)
    assert any(line.startswith("capital S: false: ") for line in lines)


def test_the_moment_and_the_last_decision_are_told_on_request() -> None:
    predict()
    lines = Lesson(
        [("problem: ", ""), ("odom_callback waits 8.9 s: group A held", "N"), ("queued", "q")]
    ).run()
    assert "timer_callback runs on MainThread for 8.9 s" in lines


def test_another_number_of_threads_is_run_at_once() -> None:
    predict()
    typist = Lesson([("The run begins", "t"), ("How many threads", "4"), ("it runs again", "q")])
    typist.run()
    assert [each.setup.threads for each in typist.engines.sessions] == [None, 4]
    assert all(each.stopped for each in typist.engines.sessions)


def test_looking_back_tells_what_ran_and_what_waited_and_why() -> None:
    predict()
    script = [
        ("problem: ", "G"),
        ("Which second", "6"),
        ("6.000 s; the last event", ",|0"),
        ("12.900 s: the present", " "),
        ("time stands still", ".|G"),
        ("it runs on", "60|q"),
    ]
    typist = Lesson(script)
    lines = typist.run()
    back = lines[lines.index("6.000 s; the last event before that:") :]
    assert "timer_callback runs on MainThread for 2.0 s" in back
    waits = next(line for line in back if "odom_callback has waited since 4.0" in line)
    assert waits.startswith("group A held")
    assert [type(each) for each in typist.engines.latest.commands] == [Pause, Step, RunUntil]


def test_what_went_by_while_one_looked_back_is_not_told() -> None:
    predict()
    typist = Lesson([("problem: ", ",|0"), ("the present", "q")])
    assert len([line for line in typist.run() if line.startswith("problem: group starvation")]) == 1


def test_a_cure_is_tried_by_its_number_and_the_run_with_it_is_compared(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    predict()
    monkeypatch.setattr(CureTrial, "judge", lambda *_: Verdict(True, "deadlock"))
    script = [
        ("problem: ", "d"),
        ("Type the number of a problem", "1"),
        ("no call differs", "q"),
    ]
    typist = Lesson(script)
    lines = typist.run()
    assert any(line.startswith("Tried, it helps: give timer_callback") for line in lines)
    assert "self.timer_group = MutuallyExclusiveCallbackGroup()" in lines
    assert "executor = MultiThreadedExecutor(num_threads=2)" in lines
    assert typist.engines.latest.setup.threads == 2
    assert "run A: shared-group, as written" in lines
    assert "run B: shared-group, timer own group, 2 threads" in lines


def test_the_learner_becomes_the_scheduler_from_a_paused_moment_on_and_comes_back() -> None:
    predict()
    typist = Lesson([("problem: ", " "), ("time stands still", "W|q"), ("back to", " |q")])
    lines = typist.run()
    assert "You are the scheduler" in lines
    lesson, choosing = typist.engines.sessions
    assert choosing.setup.explored_from == ns(12.9)
    assert choosing.stopped
    assert isinstance(lesson.commands[-1], Resume)


def test_a_program_that_reads_is_told_of_and_typed_for() -> None:
    predict()
    reads = KeyboardAsked(ns(12.9), Reading.LINES, "teleop.py")
    script = [("teleop.py waits for the keyboard: press i", "i"), ("For the program", "w|q")]
    typist = Lesson(script, more=[reads])
    typist.run()
    assert typist.engines.latest.commands == [TerminalInput("w\n")]


def test_a_recording_is_played_and_gone_through_in_lines(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    write(path, EVENTS, RecordingMetadata(title="shared-group", clock="virtual"))
    script = [
        ("plays it", "G|4.9"),
        ("4.900 s; the last", "G|13.9| "),
        ("timer_callback returns", "0"),
        ("the end", "q"),
    ]
    lines = Typist(script, lambda terminal: ReplayConsole(terminal, read(path))).run()
    assert "timer_callback runs on MainThread for 900 ms" in lines
    assert any(line.startswith("14.000 s: timer_callback returns after 10.0 s") for line in lines)
    assert not any(line.startswith("4.000 s: timer_callback runs") for line in lines)


def test_a_puzzle_is_played_by_numbers() -> None:
    sessions = Asking()
    script = [
        ("2: Pool-0_1 looks for work", "?|1|9|u|2|2"),
        ("Done in 2 moves", "q"),
    ]
    subject = of_puzzle(PUZZLE)
    lines = Typist(script, lambda terminal: ChoosingConsole(terminal, subject, sessions, PUZZLE)).run()
    assert "There is no thread 9 to choose now." in lines
    assert any(line.startswith("capital H: solution: ") for line in lines)
    assert not any(line.endswith(": pane: Read the guide") for line in lines)  # 1 chooses
    assert lines.count("Choice 1, 0 moves. Who goes on?") == 2
    assert Progress().of(PUZZLE.id).passed


def test_a_chain_that_cannot_be_followed_is_refused_with_the_names_there_are() -> None:
    predict()
    script = [
        ("problem: ", "k"),
        ("From which to which", "odom"),
        ("a chain has a first and a last", "k"),
        ("From which to which", "/odom:/nowhere"),
        ("nothing was sent on /nowhere", "q"),
    ]
    Lesson(script).run()


def test_an_export_is_written_and_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    predict()
    monkeypatch.chdir(tmp_path)
    script = [
        ("problem: ", "x"),
        ("Export the run so far", "9"),
        ("There is no format 9", "x"),
        ("2: report", "2"),
        ("Exported to", "q"),
    ]
    Lesson(script).run()
    assert [path.suffix for path in tmp_path.iterdir()] == [".md"]


def test_a_callback_gets_another_group() -> None:
    predict()
    script = [
        ("problem: ", "g"),
        ("Which callback", "2"),
        ("Which group", "mine"),
        ("There is no group mine", "g"),
        ("Which callback", "2"),
        ("Which group", "own"),
        ("it runs again", "q"),
    ]
    typist = Lesson(script)
    typist.run()
    (change,) = typist.engines.latest.setup.groups
    assert change.wish == "own"


@pytest.mark.slow
def test_an_exercise_is_made_and_a_changed_file_checked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    predict(EXERCISE)
    monkeypatch.chdir(tmp_path)
    lesson = find(EXERCISE)
    assert lesson.solution_path is not None
    Lesson([("problem: ", "e"), ("checks it then", "q")], lesson=EXERCISE).run()
    (file,) = tmp_path.iterdir()
    file.write_text(lesson.solution_path.read_text(encoding="utf-8"), encoding="utf-8")
    lines = Lesson([("problem: ", "e"), ("The exercise is solved", "q")], lesson=EXERCISE).run()
    assert any(line.endswith("checks passed") for line in lines)
    assert Progress().of(EXERCISE).passed


def test_an_exercise_that_is_opened_is_told_at_once_without_predictions(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    lines = Lesson([("checks it then", "q")], lesson=EXERCISE, with_exercise=True).run()
    (file,) = tmp_path.iterdir()
    assert any(line.startswith(f"Edit {file}; e checks it then") for line in lines)
    assert Progress().of(EXERCISE).answers == ()


def test_the_solution_is_told_line_by_line_after_a_warning(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    predict(EXERCISE)
    monkeypatch.chdir(tmp_path)
    script = [
        ("problem: ", "H"),
        ("after the explanation: press a", "a"),
        ("Checked against", "H"),
        ("3 hints are left. Type yes", "yes"),
        ("split_groups.py becomes the solution", "H"),
        ("split_groups.py becomes the solution", "q"),
    ]
    lines = Lesson(script, lesson=EXERCISE).run()
    assert Progress().of(EXERCISE).solution
    assert any(" comes: " in line and "CallbackGroup" in line for line in lines)


def test_what_goes_and_comes_has_the_number_of_its_line() -> None:
    assert list(told_difference("a\nb\nc\n", "a\nB\nc\nd\n")) == [
        "line 2 goes: b",
        "line 2 comes: B",
        "line 4 comes: d",
    ]


def test_a_value_of_the_set_up_is_changed() -> None:
    predict()
    script = [
        ("problem: ", "p"),
        ("1: timer_callback period, now 0.5 s, 2: robot's sensors rate, now 20 Hz, 3: rclpy release", "1"),
        ("Which period? Give 0.001 to 3600 s", "0"),
        ("0 is not a period", "p"),
        ("Which setting?", "3"),
        ("Which release? Give humble", "kilted"),
        ("it runs again", "q"),
    ]
    typist = Lesson(script)
    typist.run()
    assert typist.engines.latest.setup.distro == "kilted@9.1.2"


def test_a_run_is_recorded_to_the_current_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    predict()
    monkeypatch.chdir(tmp_path)
    lines = Lesson([("problem: ", "R"), ("Recording to", "R"), ("Recorded", "q")]).run()
    assert [path.suffix for path in tmp_path.iterdir()] == [".mcap"], lines


def test_the_code_is_read_with_the_numbers_of_its_lines() -> None:
    predict()
    lines = Lesson([("problem: ", "2"), ("rclpy.init", "q")]).run()
    assert any(line.startswith("120: def main") for line in lines)


def test_hints_come_one_by_one_once_the_lesson_is_explained() -> None:
    predict(EXERCISE)
    exercise = find(EXERCISE).exercise
    assert exercise is not None
    script = [("problem: ", "h"), ("after the explanation", "a"), ("Checked against", "h|q")]
    Lesson(script, lesson=EXERCISE).run()
    assert Progress().of(EXERCISE).hints == 1
