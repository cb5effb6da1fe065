"""Reads the sealed trace of a program that is not trusted, and collects signs of a forgery."""

import ast
import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from types import CodeType

from cbtui.grading.submission import Submission
from lessons.catalogue import ROOT as LESSONS
from sim.trace.events import AnyEvent, EntityAppeared, Notice, NoticeKind, decode
from sim.trace.integrity.plausibility import Plausibility
from sim.trace.integrity.sealing import BrokenSealError, Seal

_OURS = ("cbtui", "cbtui_probe", "lessons", "sim")
_WORD = re.compile(r"\w+")


class TraceAudit:
    """Audits the batches of one run.

    ``folder`` has the program's files, ``libraries`` are folders of other code. ``virtual`` tells that the
    run is on virtual time, where all events are in order. On real ROS 2 a program reports its own
    actions, and may lie; it cannot forge what is measured outside of it, such as the robot.
    """

    def __init__(
        self, key: bytes, submission: Submission, folder: Path, libraries: Sequence[Path], *, virtual: bool
    ) -> None:
        self._seal = Seal(key)
        self._is_broken = False
        self._submission = submission
        self._folder = folder
        self._libraries = libraries
        self._plausibility = Plausibility() if virtual else None
        self._doubts = dict.fromkeys(_imports_of_ours(submission))
        self._code = {name: frozenset(_spans(source)) for name, source in submission.files.items()}
        self._words = {word for source in submission.files.values() for word in _words(source)}

    def unpack(self, data: bytes) -> list[AnyEvent]:
        """Return the events of a batch; none if its seal is not the engine's.

        Raises:
            msgspec.DecodeError: a sealed batch cannot be decoded.
        """
        try:
            batch = self._seal.open(data)
        except BrokenSealError as error:
            if not self._is_broken:
                self._doubt(str(error))
            self._is_broken = True
            return []
        for name in batch.replaced[:1]:
            self._doubt(f"the program replaced {name}, which is the engine's own")
        events = decode(batch.events)
        if self._plausibility is not None:
            self._plausibility.take(events)
        for event in events:
            if isinstance(event, EntityAppeared) and event.file:
                self._look_at_origin(event)
            elif isinstance(event, Notice) and event.kind is NoticeKind.FORGED:
                self._doubt(event.text)
        return events

    def doubts(self, *, ended_normally: bool) -> tuple[str, ...]:
        """Return the signs of a forgery after the run."""
        if self._plausibility is not None:
            if ended_normally:
                self._plausibility.finish()
            self._doubt(*self._plausibility.faults)
        for name, source in self._submission.files.items():
            if name.endswith(".py") and not _holds(self._folder / name, source):
                self._doubt(f"{name} was changed while it ran")
        return tuple(self._doubts)

    def _doubt(self, *sentences: str) -> None:
        self._doubts |= dict.fromkeys(sentences)

    def _look_at_origin(self, event: EntityAppeared) -> None:
        file = Path(event.file)
        if not file.is_relative_to(self._folder):
            known = any(file.is_relative_to(folder) for folder in self._libraries)
            if not known or file.is_relative_to(LESSONS):
                self._doubt(f"the callback {event.callback} is in {file}, which was not handed in")
            return
        name = str(file.relative_to(self._folder))
        is_there = (event.first_line, event.last_line) in self._code.get(name, ())
        if not is_there or not self._words.issuperset(_WORD.findall(event.callback)):
            where = f"{name}:{event.first_line}"
            self._doubt(f"the callback {event.callback} is said to be at {where}, and it is not there")


def _holds(path: Path, content: bytes) -> bool:
    try:
        return path.read_bytes() == content
    except OSError:
        return False


def _words(source: bytes) -> list[str]:
    return _WORD.findall(source.decode(errors="replace"))


def _spans(source: bytes) -> Iterator[tuple[int, int]]:
    """Yield the first and last line of every function in a source; nothing if it is not valid Python."""
    try:
        waiting: list[object] = [compile(source, "", "exec", dont_inherit=True)]
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return
    for code in waiting:
        if isinstance(code, CodeType):
            lines = [line for _, _, line in code.co_lines() if line is not None]
            yield code.co_firstlineno, max(lines, default=code.co_firstlineno)
            waiting += code.co_consts


def _imports_of_ours(submission: Submission) -> Iterator[str]:
    own = {Path(name).parts[0].removesuffix(".py") for name in submission.files}
    for name, source in submission.files.items():
        if name.endswith(".py"):
            for line, module in _imports(source):
                root = module.partition(".")[0]
                if root in _OURS and root not in own:
                    yield f"{name}:{line} imports {module}, which is not part of ROS 2"


def _imports(source: bytes) -> Iterable[tuple[int, str]]:
    try:
        nodes = [*ast.walk(ast.parse(source))]
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return
    for node in nodes:
        if isinstance(node, ast.Import):
            yield from ((node.lineno, alias.name) for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and not node.level:
            yield node.lineno, node.module or ""
