"""Verifies a lesson: the claims of its files about its node, starter and solution, tested by running them."""

import re
from collections.abc import Iterable, Iterator
from pathlib import Path

from msgspec import structs

from cbtui.keys.actions import ACTIONS
from cbtui.keys.signs import character_of
from cbtui.runs.judged.check_text import verdict_line
from cbtui.runs.judged.checking import ObservedRun, observe
from cbtui.runs.setup.lesson_setup import setup_to_judge
from lessons.checks import problems
from lessons.description import Prediction
from lessons.judge import Judge
from lessons.lesson import DESCRIPTION_FILE, EXPLANATION_FILE, GUIDE_FILE, BadLesson, Lesson, read_lesson
from sim.diagnosis import RULES
from sim.diagnosis.rules.errors import ProgramRaised
from sim.files import untrusted

WIDTH = 79
"""The longest line of a guide in columns, for the narrowest terminals."""
_LIMIT = 60.0
_REAL_CLOCK_FACTOR = 3
_QUOTED = re.compile(r"`([^`\n]+)`")
_KEY = re.compile(
    r"\S|f\d\d?|(ctrl|shift|alt)\+\S+|space|tab|enter|escape|up|down|left|right|home|end|pageup|pagedown|"
    r"delete|backspace|insert"
)


def faults_of(folder: Path, limit: float = _LIMIT) -> Iterator[str]:
    """Yield a sentence on each fault of the lesson in a folder.

    Runs up to three programs, for ``limit`` real seconds each at most.
    """
    try:
        lesson = read_lesson(folder.resolve())
        yield from faults_in_texts(lesson)
        yield from faults_in_runs(lesson, Judge(lesson), limit)
    except BadLesson as error:
        yield str(error)


def faults_in_texts(lesson: Lesson) -> Iterator[str]:
    """Yield the faults of a lesson's texts and of the names in its description."""
    if not lesson.predictions:
        yield f"{_in(lesson, DESCRIPTION_FILE)}: there is no [[prediction]]; a lesson asks one or two"
    if lesson.guide.partition("\n")[0] != f"# {lesson.title}":
        yield f"{_in(lesson, GUIDE_FILE)}:1: the first line is not the title, '# {lesson.title}'"
    for file, text in ((GUIDE_FILE, lesson.guide), (EXPLANATION_FILE, lesson.explanation)):
        yield from _decoding_faults(lesson.folder / file)
        for number, line in enumerate(text.splitlines(), start=1):
            if len(line) > WIDTH:
                yield f"{_in(lesson, file)}:{number}: the line is {len(line)} characters long; {WIDTH} fit"
        yield from _key_faults(_in(lesson, file), text)
    yield from _key_faults(_in(lesson, DESCRIPTION_FILE), _texts(lesson))
    for tried in lesson.tries:
        if tried.key not in _keys():
            yield f"{_in(lesson, DESCRIPTION_FILE)}: no key {tried.key!r} exists, which a [[try]] names"
    yield from _drift(lesson)
    known = {rule.id for rule in RULES}
    declared = lesson.diagnoses
    for rule in dict.fromkeys((*declared.node, *declared.starter, *declared.solution)):
        if rule not in known:
            yield f"{_in(lesson, DESCRIPTION_FILE)}: the diagnosis has no rule {rule!r}"


def _decoding_faults(path: Path) -> Iterator[str]:
    try:
        untrusted.read_text(path)
    except FileNotFoundError:  # there need not be an explanation
        return
    except UnicodeDecodeError as error:
        yield f"{path}:{untrusted.decoding_fault(error)}"


def _drift(lesson: Lesson) -> Iterator[str]:
    """Yield a fault if starter and solution share lines that the node lacks: the three files have drifted."""
    exercise = lesson.exercise
    if exercise is None or exercise.beyond_node is not None:
        return
    files = (lesson.setup.node, exercise.starter, exercise.solution)
    node, starter, solution = (_lines(lesson, file) for file in files)
    drifted = [str(n) for n, line in enumerate(starter, 1) if line and line in solution and line not in node]
    if drifted and starter != solution:
        yield (
            f"{_in(lesson, exercise.starter)}:{drifted[0]}: {exercise.solution} has this line too, and "
            f"{lesson.setup.node} has not (lines {', '.join(drifted)}): change all three, or set beyond_node"
        )


def _lines(lesson: Lesson, file: str) -> list[str]:
    return [line.strip() for line in untrusted.read_text(lesson.folder / file, errors="replace").splitlines()]


def _texts(lesson: Lesson) -> str:
    """The texts of the description that may name keys."""
    texts = [lesson.task or "", *(tried.text for tried in lesson.tries)]
    if lesson.exercise is not None:
        texts += [lesson.exercise.asks, *lesson.exercise.hints]
    return "\n".join(texts)


def _key_faults(file: str, text: str) -> Iterator[str]:
    """Yield the unknown keys in a text; a key is in backticks and looks like one."""
    quoted = dict.fromkeys(_QUOTED.findall(text))
    for name in quoted:
        if _KEY.fullmatch(name) and name not in _keys():
            yield f"{file}: no key `{name}` exists"


def _keys() -> set[str]:
    names = {key for action in ACTIONS for key in action.key.split(",")}
    return names | {character for character in map(character_of, names) if character is not None}


def faults_in_runs(lesson: Lesson, judge: Judge, limit: float) -> Iterator[str]:
    """Yield claims of a lesson that the runs of its node, starter and solution refute.

    On the real clock, where a busy machine may be too slow, a fault counts only if it also occurs in runs of
    three times the length.

    Raises:
        BadLesson: an answer cannot be read off a run.
    """
    if lesson.setup.clock == "real" and _is_faultless(lesson, judge, limit):
        return
    run = lesson.run
    if lesson.setup.clock == "real":
        run = structs.replace(run, seconds=_REAL_CLOCK_FACTOR * run.seconds)
    yield from _faults_in_runs(structs.replace(lesson, run=run), judge, limit)


def _is_faultless(lesson: Lesson, judge: Judge, limit: float) -> bool:
    try:
        return not any(_faults_in_runs(lesson, judge, limit))
    except BadLesson:
        return False


def _faults_in_runs(lesson: Lesson, judge: Judge, limit: float) -> Iterator[str]:
    declared = lesson.diagnoses
    node = observe(setup_to_judge(lesson), lesson.setup.node, limit)
    yield from _run_faults(lesson, lesson.setup.node, node, declared.node)
    for prediction in () if node.broken_off else lesson.predictions:
        shown = _shown(lesson, judge, prediction, node)
        if shown != prediction.right:
            yield (
                f"{_in(lesson, DESCRIPTION_FILE)}: {prediction.question!r}: right is {prediction.right}, "
                f"and the run shows {shown}, {prediction.answers[shown]!r}"
            )
    if lesson.exercise is None or lesson.starter_path is None or lesson.solution_path is None:
        return
    starter = observe(setup_to_judge(lesson, lesson.starter_path), lesson.exercise.starter, limit)
    yield from _run_faults(lesson, lesson.exercise.starter, starter, declared.starter)
    verdicts = judge.verdicts(starter.timeline)
    if all(each.verdict.passed for each in verdicts) and starter.trouble is None:
        yield f"{lesson.starter_path}: passes every check, so that there is nothing to mend"
    solution = observe(setup_to_judge(lesson, lesson.solution_path), lesson.exercise.solution, limit)
    yield from _run_faults(lesson, lesson.exercise.solution, solution, declared.solution)
    if solution.trouble is not None:
        yield f"{lesson.solution_path}: {solution.trouble}"
    for each in judge.verdicts(solution.timeline):
        if not each.verdict.passed:
            yield f"{lesson.solution_path}: fails '{each.check.asks}': {verdict_line(each)}"


def _shown(lesson: Lesson, judge: Judge, prediction: Prediction, node: ObservedRun) -> int:
    """Return the answer that the node's run shows to be true.

    Raises:
        BadLesson: the run shows no answer; if it failed, the text says why.
    """
    try:
        return judge.true_answer(prediction, node.timeline)
    except BadLesson as error:
        if node.trouble is None:
            raise
        raise BadLesson(f"{_in(lesson, lesson.setup.node)}: {node.trouble}") from error


def _run_faults(lesson: Lesson, file: str, run: ObservedRun, declared: Iterable[str]) -> Iterator[str]:
    """Yield faults of a run apart from its checks: an abort, or undeclared or missing diagnoses."""
    if run.broken_off:
        yield f"{_in(lesson, file)}: {run.trouble}"
        return
    found = {each.rule.id for each in problems(run.timeline)}
    if run.trouble is not None:  # which is declared, or has to be mended
        found -= {ProgramRaised.id} - set(declared)
    for rule in sorted(found - set(declared)):
        yield f"{_in(lesson, file)}: the diagnosis finds {rule}, which [diagnoses] does not declare"
    for rule in sorted(set(declared) - found):
        yield f"{_in(lesson, file)}: the diagnosis does not find {rule}, which [diagnoses] declares"


def _in(lesson: Lesson, file: str) -> str:
    return str(lesson.folder / file)
