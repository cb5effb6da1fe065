"""A file of the learner's own on screen: run again when it is saved, with a guide written as it runs."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from textual.message import Message
from textual.screen import Screen

from cbtui.runs.judged.cures import cures_of
from cbtui.runs.live.file_watch import CANNOT_WATCH, content_of, contents
from cbtui.runs.live.live_run import LiveRun
from cbtui.runs.setup.program_page import MOST, nodes_spun, page_of_program, unspun_nodes
from cbtui.runs.setup.unmet_changes import UnmetChange, UnmetChanges
from cbtui.screens.parts.panes import PaneLayout
from cbtui.screens.parts.part import ScreenHost, ScreenPart
from cbtui.screens.parts.restarts import Restarts
from cbtui.screens.parts.runs import RunController
from cbtui.text.changed_lines import changed_lines
from cbtui.widgets.guide import Guide


@dataclass
class FileRead(Message):
    """The file was read; ``content`` may be unchanged, None if the file is missing."""

    content: bytes | None


async def read_when_saved(file: Path, post: Callable[[Message], object], tell: Callable[[str], None]) -> None:
    """Post ``FileRead`` after each save; ends when its task is cancelled, or nothing can be watched."""
    try:
        async for content in contents(file):
            post(FileRead(content))
    except CANNOT_WATCH:
        tell(f"{file.parent} cannot be watched, so saving is not noticed there.")


@dataclass
class OwnFile(ScreenPart):
    """Runs a learner's file again when it is saved, and writes its guide."""

    screen: Screen[None]
    host: ScreenHost
    runs: RunController[LiveRun]
    restarts: Restarts
    panes: PaneLayout
    file: Path
    content: bytes | None = None
    """The content that the run on screen was made from."""
    _shown: object = field(default=None, init=False)
    _unmet: UnmetChanges | None = field(default=None, init=False)

    def begin(self) -> None:
        """Note that a run of the current file begins."""
        self.content = content_of(self.file)

    def page(self) -> Mapping[str, str]:
        """Return the sections of the guide."""
        run = self.runs.run
        problems = [each.explanation for each in self.runs.findings.findings if each.is_problem]
        cures = (cures_of(each, self.restarts.changes, run.timeline) for each in problems[:1])
        has_cures = run.setup.real is None and any(True for each in cures for _ in each)
        return page_of_program(
            self.file.name,
            run.setup.clock,
            run.timeline,
            problems,
            has_cures=has_cures,
            unmet=self._unmet_in(run),
        )

    def _unmet_in(self, run: LiveRun) -> list[UnmetChange]:
        if self._unmet is None or self._unmet.setup is not run.setup:
            self._unmet = UnmetChanges(run.setup)
        return self._unmet.now(run.timeline)

    def update_guide(self) -> None:
        """Write the guide again if the findings changed.

        A program that fails before it has a callback, for example with a syntax error, is shown at its line.
        """
        timeline, findings = self.runs.timeline, self.runs.findings.findings
        unspun = unspun_nodes(timeline)
        what = (timeline.nodes, timeline.executors, timeline.groups, timeline.entities, timeline.names_sent)
        state = (
            *(min(len(each), MOST + 1) for each in what),
            timeline.ended is None,
            timeline.arena is None,
            unspun,
            nodes_spun(timeline, unspun),
            [each.explanation for each in findings if each.is_problem],
        )
        if state != self._shown:
            self._shown = state
            ended = timeline.ended
            if ended is not None and ended.problem and not timeline.entities:
                self.panes.show("code")
            self.screen.call_next(self.screen.query_one(Guide).show, self.page())

    async def take(self, content: bytes | None) -> None:
        """Run the file again if its content is new."""
        if content is not None and content != self.content:
            before, after = ((each or b"").decode(errors="replace") for each in (self.content, content))
            await self.run_anew(self.file.name, changed_lines(before, after))

    async def run_anew(self, saved: str, edit: str = "") -> None:
        """Run the file again after one of the program's files was saved; replaces an edited copy."""
        changes = replace(self.restarts.changes, texts={})
        changed = f", still changed: {changes.words}" if changes.words else ""
        self.host.tell(f"{saved} was saved: it runs again{changed}.")
        await self.restarts.again(changes, edit=edit or f"{saved} was saved")
