"""``--screen-reader``: the console in lines instead of a screen."""

from collections.abc import Sequence
from pathlib import Path
from time import time
from typing import TYPE_CHECKING, Any

from cbtui.text.output import complain, say

if TYPE_CHECKING:
    from cbtui.commands.options.appearance import Appearance
    from cbtui.runs.setup.changes import Changes
    from cbtui.runs.setup.shown_program import ShownProgram
    from cbtui.screens.linear.console import LinearConsole, LineTerminal
    from lessons.puzzles import Puzzle
    from sim.recording import Recording


def open_in_lines(
    look: "Appearance",
    start_lesson: str | None = None,
    start_exercise: str | None = None,
    start_puzzle: "Puzzle | None" = None,
    start_file: tuple[Path, Sequence[str], str] | None = None,
    start_changes: "Changes | None" = None,
    start_program: "ShownProgram | None" = None,
    start_recording: "Recording | None" = None,
) -> int:
    """Run the console in lines; it asks what to open if nothing is given.

    Returns the exit code.
    """
    from cbtui.runs.setup.shown_program import of_file, of_lesson
    from cbtui.screens.linear.console import LineTerminal
    from cbtui.screens.linear.keyboard import KeyReader
    from lessons.catalogue import find, lessons

    for sentence in look.complaints:
        complain(sentence)
    keyboard = KeyReader()
    terminal = LineTerminal(keyboard, lambda line: say(f"{line}\n"), look.keys)
    keyboard.give = terminal.typed.put
    with keyboard.opened():
        keyboard.take_lines(wanted=False)
        console: LinearConsole[Any] | None
        if start_recording is not None:
            console = _recording(terminal, start_recording)
        elif start_puzzle is not None:
            console = _puzzle(terminal, start_puzzle)
        elif (lesson := start_lesson or start_exercise) is not None:
            subject = of_lesson(find(lesson), lessons())
            console = _program(terminal, subject, start_changes, with_exercise=start_exercise is not None)
        elif start_file is not None:
            console = _program(terminal, of_file(*start_file), start_changes)
        elif start_program is not None:
            console = _program(terminal, start_program, None)
        else:
            console = _chosen(terminal)
        while console is not None:
            keyboard.give = console.typed
            following = console.run()
            console = None if following is None else _program(terminal, of_lesson(following, lessons()), None)
    return 0


def _program(
    terminal: "LineTerminal",
    subject: "ShownProgram",
    changes: "Changes | None",
    *,
    with_exercise: bool = False,
) -> "LinearConsole[Any]":
    from cbtui.engines.listening import ListeningSession
    from cbtui.learning.outcome import observe_engine
    from cbtui.runs.setup.changes import Changes
    from cbtui.screens.linear.lesson import LessonConsole

    changes = changes or Changes()
    return LessonConsole(terminal, subject, changes, ListeningSession, observe_engine, with_exercise)


def _recording(terminal: "LineTerminal", recording: "Recording") -> "LinearConsole[Any]":
    from cbtui.screens.linear.replay import ReplayConsole

    return ReplayConsole(terminal, recording)


def _puzzle(terminal: "LineTerminal", puzzle: "Puzzle") -> "LinearConsole[Any]":
    from cbtui.engines.listening import ListeningSession
    from cbtui.runs.setup.shown_program import of_puzzle
    from cbtui.screens.linear.choosing import ChoosingConsole

    return ChoosingConsole(terminal, of_puzzle(puzzle), ListeningSession, puzzle)


def _chosen(terminal: "LineTerminal") -> "LinearConsole[Any] | None":
    """Return the typed lesson's number or id, puzzle's id, or path; None at the end of input."""
    from cbtui.runs.setup.own_files import CannotOpenError, entry_for, read_recording
    from cbtui.runs.setup.recent import RecentKind
    from cbtui.runs.setup.shown_program import of_file, of_lesson
    from lessons.catalogue import lessons
    from lessons.puzzles import puzzles, puzzles_of

    for lesson in lessons():
        say(f"{lesson.number}: {lesson.title}, {lesson.id}\n")
        for puzzle in puzzles_of(lesson.id):
            say(f"puzzle: {puzzle.title}, {puzzle.id}\n")
    terminal.keyboard.take_lines(wanted=True)
    while True:
        say("What do you want to open? Type a lesson's number, a puzzle's id, or a path:\n")
        line = terminal.typed.get()
        if line is None:
            return None
        typed = line.strip()
        for lesson in lessons():
            if typed in (lesson.id, str(lesson.number)):
                return _program(terminal, of_lesson(lesson, lessons()), None)
        for puzzle in puzzles():
            if typed == puzzle.id:
                return _puzzle(terminal, puzzle)
        try:
            entry = entry_for(typed, time())
            path = Path(entry.what)
            if entry.kind is RecentKind.RECORDING:
                return _recording(terminal, read_recording(path))
            return _program(terminal, of_file(path, (), entry.clock), None)
        except CannotOpenError as error:
            say(f"There is no lesson or puzzle {typed}. {error}\n")
