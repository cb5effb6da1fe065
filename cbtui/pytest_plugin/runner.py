"""The fixture's value: runs programs for a test, with one or many thread schedules."""

import os
import warnings
from collections.abc import Mapping
from contextlib import closing
from functools import cache, partial
from pathlib import Path
from typing import Any

import msgspec
import pytest

from cbtui.commands.options.targets import is_file_name
from cbtui.engines.forking import forking_context
from cbtui.engines.session import SPAWN_CONTEXT, ProcessSession
from cbtui.pytest_plugin.checked_run import CheckedRun, Outcome
from cbtui.pytest_plugin.failure_report import Recordings
from cbtui.pytest_plugin.terms import BadTermsError, RunTerms
from cbtui.runs.judged.checking import observe
from cbtui.runs.judged.exploring import PRELOADED, each_schedule
from lessons.catalogue import UnknownLesson, find
from lessons.lesson import Lesson
from sim.clock.schedule import Seed
from sim.engine.setup import RunSetup
from sim.trace.events import AnyEvent, Severity

__tracebackhide__ = True


class Runner:
    """Runs programs on the terms of one test: those of its marks, the nearest first, and of each call."""

    def __init__(self, request: pytest.FixtureRequest) -> None:
        self._config = request.config
        self._folder = request.path.parent
        folder = Path(request.config.rootpath, request.config.getini("cbtui_recordings"))
        self._recordings = Recordings(folder, request.node.nodeid)
        self._terms = RunTerms()
        for mark in reversed([*request.node.iter_markers("cbtui")]):
            if mark.args:
                raise pytest.UsageError(
                    "the mark cbtui takes no program: name it in the test, cbtui('node.py')"
                )
            self._terms = self._changed(self._terms, mark.kwargs)

    def __call__(self, *targets: str | os.PathLike[str], may_fail: bool = False, **terms: Any) -> CheckedRun:
        """Run a lesson, a file in the place of a lesson's node, or files; returns the finished run.

        Files are looked for beside the test, then in pytest's root folder. ``terms`` go before those of the
        mark. A program that raises, or does not come to its end, fails the test unless it ``may_fail``; so
        do callbacks that raise only when they are asked for, with ``never_raises``.
        """
        asked = self._changed(self._terms, terms)
        lesson, files = self._found([os.fspath(each) for each in targets])
        try:
            setup = asked.setup(lesson, files)
        except BadTermsError as error:
            raise pytest.UsageError(str(error)) from None
        name = setup.title if lesson is None or not files else files[0].name
        seeds = asked.seeds
        if len(seeds) == 1:
            outcomes = [_single(setup, name, asked.limit, seeds[0])]
        else:
            found = each_schedule(setup, name, asked.limit, seeds, lambda observed: observed)
            with closing(found):
                outcomes = [Outcome(seed, observed) for seed, observed in found]
        again = partial(_single, setup, name, asked.limit)
        outcomes.sort(key=lambda each: seeds.index(each.seed))
        run = CheckedRun(outcomes, setup, lesson, again, self._recordings)
        for notice in run.timeline.notices:
            if notice.severity is Severity.WARN:
                warnings.warn(notice.text, stacklevel=2)
        if not may_fail:
            run.ends_well()
        return run.has_callbacks(*asked.callbacks)

    def _changed(self, terms: RunTerms, given: Mapping[str, Any]) -> RunTerms:
        options = {"on": self._config.getoption("cbtui_on"), "seed": self._config.getoption("cbtui_seed")}
        try:
            return terms.changed(
                {**given, **{name: value for name, value in options.items() if value is not None}}
            )
        except BadTermsError as error:
            raise pytest.UsageError(str(error)) from None

    def _found(self, targets: list[str]) -> tuple[Lesson | None, list[Path]]:
        lesson = None
        if targets and not is_file_name(targets[0]):
            try:
                lesson = find(targets[0])
            except UnknownLesson as error:
                raise pytest.UsageError(str(error)) from None
        files = [self._file(name) for name in targets[0 if lesson is None else 1 :]]
        if not targets or (lesson is not None and len(files) > 1):
            raise pytest.UsageError("cbtui() takes files, or a lesson, or a lesson and one file in its place")
        return lesson, files

    def _file(self, name: str) -> Path:
        places = (self._folder / name, self._config.rootpath / name)
        found = next((path for path in places if path.is_file()), None)
        if found is None:
            raise pytest.UsageError(
                f"there is no file {name} beside the test, and none in {places[1].parent}"
            )
        return found


def _single(setup: RunSetup, name: str, limit: float, seed: Seed) -> Outcome:
    """Run one schedule, and keep all its events and the contents of its messages."""
    kept: list[AnyEvent] = []
    asked = msgspec.structs.replace(setup, contents=True, seed=seed or None)
    server = _server_environment()
    context = forking_context(PRELOADED) if server == _environment() else SPAWN_CONTEXT
    session = partial(ProcessSession, context=context)
    return Outcome(seed, observe(asked, name, limit, open_session=session, take=kept.extend), kept)


@cache
def _server_environment() -> Mapping[str, str]:
    """The environment of the first run, which forked engines have."""
    return _environment()


def _environment() -> Mapping[str, str]:
    return {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")}
