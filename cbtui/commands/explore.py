"""``cbtui explore``: runs a program under other thread schedules and reports the outcomes."""

import argparse
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING

from cbtui.commands.check import add_limit, exercise_of
from cbtui.commands.options import changes, inputs, more_lessons, outputs, values
from cbtui.commands.options.targets import file_of, is_file_name, lesson_of, refuse
from cbtui.terminal.interrupts import INTERRUPTED
from cbtui.text.output import complain, say

if TYPE_CHECKING:
    from collections.abc import Generator

    from cbtui.runs.judged.exploration_text import ReplayCommand, Shrunk
    from cbtui.runs.judged.exploring import Exploration, ScheduleResult, SeedT
    from cbtui.runs.judged.shards import Shard
    from lessons.lesson import Lesson
    from sim.clock.schedule import Seed

DEFAULT_SECONDS = 10.0
SCHEDULES, MOST_SCHEDULES = 100, 10_000
SHRINKING = 50
"""The least number of schedules to try when looking for a simpler failing one; else as many as were run."""


def add_options(parser: argparse.ArgumentParser) -> None:
    """Add the command's arguments."""
    parser.add_argument(
        "target", metavar="FILE.py|LESSON", nargs="?", help="a file, or a lesson's id, see cbtui list"
    )
    parser.add_argument(
        "--schedules",
        metavar="N",
        type=values.count,
        help=f"how many orders ({SCHEDULES}; with --preemptions at most {MOST_SCHEDULES})",
    )
    parser.add_argument(
        "--preemptions",
        metavar="K",
        type=values.bound,
        help="in place of seeds, run every order that stops a thread which could go on at most K times",
    )
    parser.add_argument(
        "--strategy",
        choices=("pos", "pct", "random", "busy"),
        default="pos",
        help="how seeds choose: by priorities of steps, by priorities of threads, at random, or so with "
        "timers and sleeps that end up to 50 ms late, and few stalls of all threads for up to 300 ms, as on "
        "a busy machine (%(default)s)",
    )
    parser.add_argument(
        "--seed", metavar="S", type=values.seed, default=1, help="the seed of the first order (%(default)s)"
    )
    inputs.add_length(
        parser, f"how long each run lasts in its own time ({DEFAULT_SECONDS:g}; a lesson: as it says)"
    )
    inputs.add_options(parser)
    changes.add_options(parser)
    parser.add_argument("--check", metavar="LESSON", help="judge each run of the file by a lesson's checks")
    add_limit(parser, 60)
    parser.add_argument(
        "--shard",
        metavar="I/N",
        type=values.shard,
        default=(1, 1),
        help="run part I of N of the schedules, for machines that share them; see --save and --merge",
    )
    parser.add_argument(
        "--save",
        metavar="FILE.json",
        type=outputs.file_or_stream,
        help="write the results to a file, for --merge; - is standard output",
    )
    outputs.add_force(parser)
    parser.add_argument(
        "--merge",
        metavar="FILE.json",
        nargs="+",
        help="run nothing, and report the results of such files together",
    )
    more_lessons.add_option(parser)


def explore(options: argparse.Namespace) -> int:
    """Run a program under other schedules; returns the exit code: 0 if all succeeded, 1 if some failed.

    It is 2 if a callback is to be changed that the program does not have.

    Ctrl-C ends it early with 130; the results so far are printed all the same.
    """
    if options.merge is not None:
        return _merge(options)
    from msgspec.structs import replace

    from cbtui.runs.judged.shards import BadShardError, Shard

    if options.target is None:
        refuse("explore needs a FILE.py or a LESSON; cbtui list lists the lessons")
    _check(options)
    files = filter(is_file_name, [options.target])
    outputs.check_outputs({"--save": options.save}, map(Path, files), force=options.force)
    exploration, replays = _of_file(options) if is_file_name(options.target) else _of_lesson(options)
    part, parts = options.shard
    shard = Shard(
        program=exploration.name,
        replays=tuple(replays),
        first=options.seed,
        schedules=options.schedules or (SCHEDULES if options.preemptions is None else MOST_SCHEDULES),
        strategy=options.strategy,
        results={},
        preemptions=options.preemptions,
        parts=1 if options.preemptions is None else parts,
    )
    run = _sample if options.preemptions is None else _search
    shard, interrupted = run(shard, exploration, part, parts)
    if options.preemptions is None and not interrupted:
        shard = replace(shard, shrunk=_shrunk(exploration, shard, part, parts))
    if shard.results:
        _tell(shard, f"part {part} of {parts}: " if parts > 1 else "")
    if options.save is not None:
        try:
            shard.write_to(Path(options.save))
        except BadShardError as error:
            complain(str(error))
            return 2
    return INTERRUPTED if interrupted else _exit_code(shard)


def _sample(shard: "Shard", exploration: "Exploration", part: int, parts: int) -> "tuple[Shard, bool]":
    """Run one part of the seeds; returns the results, and whether Ctrl-C ended the run."""
    from msgspec import structs

    numbers = range(shard.first, shard.first + shard.schedules)[part - 1 :: parts]
    usual = shard.strategy == "pos"
    seeds: list[Seed] = [number if usual else f"{shard.strategy}:{number}" for number in numbers]
    found: dict[Seed, ScheduleResult] = {}
    interrupted = _interrupted(exploration.results(seeds), found, f"of {len(seeds)} ")
    return structs.replace(shard, results={str(seed): found[seed] for seed in found}), interrupted


def _search(shard: "Shard", exploration: "Exploration", part: int, parts: int) -> "tuple[Shard, bool]":
    """Run all schedules within a bound, or one part of them; returns as ``_sample`` does."""
    from msgspec import structs

    from cbtui.runs.judged.bounded_search import BoundedSearch

    assert shard.preemptions is not None
    search = BoundedSearch(shard.preemptions, shard.schedules, part, parts)
    found: dict[str, ScheduleResult] = {}
    interrupted = _interrupted(exploration.search(search), found)
    done = (part,) if search.is_complete and not interrupted else ()
    if done:
        found = {seed: found[seed] for seed in search.counted}
    preempted = {seed: search.preempted(seed) for seed in found}
    branches = {seed: search.branches[seed] for seed in found}
    return structs.replace(
        shard, results=found, done=done, preempted=preempted, branches=branches
    ), interrupted


def _tell(shard: "Shard", whose: str = "") -> None:
    """Print the outcomes of the schedules, and the simplest failing schedule."""
    from cbtui.runs.judged.exploration_text import exploration_text, proof_text

    found, proof = shard.ranked(), ""
    if shard.preemptions is not None:
        is_complete = bool(shard.done) if whose else not shard.missing
        proof = whose + proof_text(found, shard.preemptions, is_complete=is_complete)
    say(exploration_text(shard.program, found, shard.replays, proof, shard.shrunk))


def _shrunk(exploration: "Exploration", shard: "Shard", part: int, parts: int) -> "Shrunk | None":
    """Search a simple schedule with the same failure; None if none failed, or failures are not repeatable."""
    from cbtui.runs.judged.exploration_text import Shrunk
    from cbtui.runs.judged.shrinking import Shrinking

    found = shard.results.values()
    failures = {failure for result in found for failure in result.failures}
    if not failures or not all(result.repeatable for result in found):
        return None
    shrinking = Shrinking(failures, max(len(found), SHRINKING), part, parts)
    tried: dict[str, ScheduleResult] = {}
    _interrupted(exploration.search(shrinking), tried, "further ")
    return Shrunk(len(tried), shrinking.best, tried.get(shrinking.best), shrinking.preempted)


def _interrupted(
    results: "Generator[tuple[SeedT, ScheduleResult]]", found: "dict[SeedT, ScheduleResult]", goal: str = ""
) -> bool:
    """Put the result of each seed into ``found``; returns whether Ctrl-C ended that."""
    from cbtui.terminal.progress_line import ProgressLine

    try:
        with ProgressLine() as line, closing(results):
            for seed, result in results:
                found[seed] = result
                failed = sum(not each.well for each in found.values())
                line.show(f"{len(found)} {goal}schedules, {failed} failed")
    except KeyboardInterrupt:
        complain(f"interrupted: {len(found)} {goal}schedules were tried")
        return True
    return False


def _exit_code(shard: "Shard") -> int:
    results = shard.results.values()
    if results and all(result.unmatched for result in results):
        return 2
    return 0 if all(result.well for result in results) else 1


def _merge(options: argparse.Namespace) -> int:
    """Print the merged results of several files; returns the exit code as ``explore`` does."""
    if options.target is not None or options.save is not None or options.force:
        refuse("--merge runs nothing: leave out the target, --save and --force")
    from cbtui.runs.judged.shards import BadShardError, merged

    try:
        whole = merged([Path(name) for name in options.merge])
    except BadShardError as error:
        refuse(str(error))
    if whole.results:
        _tell(whole)
    if whole.missing:
        complain(f"{whole.missing} in none of these files")
        return 1
    return _exit_code(whole)


def _check(options: argparse.Namespace) -> None:
    is_file = is_file_name(options.target)
    if options.check is not None and not is_file:
        refuse(f"a lesson is judged by its own checks; leave out --check {options.check}, or give a file")
    inputs.check(options, options.seconds or DEFAULT_SECONDS)
    if is_file and options.check is None:
        return
    if others := [name for name, given in _of_files_only(options).items() if given]:
        refuse(f"a lesson's checks are about the run that it describes; leave out {', '.join(others)}")
    if options.arguments:
        refuse("a lesson has its own arguments; leave out what follows --")


def _of_files_only(options: argparse.Namespace) -> dict[str, object]:
    """Return the given options that would change the run of a lesson's checks."""
    return {
        "--for": options.seconds,
        "--call": options.calls,
        "--at": options.lines,
        "--threads": options.threads,
        "--group": options.groups,
        "--period": options.periods,
        "--sensor-rate": options.sensor_rate,
        "--physics": options.physics,
        "--distro": options.distro,
    }


def _of_file(options: argparse.Namespace) -> "tuple[Exploration, list[ReplayCommand]]":
    """Return the exploration of a file, and the commands that repeat one schedule."""
    from cbtui.runs.judged.exploration_text import ReplayCommand

    path = file_of(options.target)
    if options.check is not None:
        lesson = exercise_of(options.check)
        again = ReplayCommand(("cbtui", "check", lesson.id, options.target))
        return _judged(lesson, options, options.target), [again]

    from cbtui.runs.judged.exploring import Exploration
    from cbtui.runs.setup.lesson_setup import RunRequest

    seconds = options.seconds or DEFAULT_SECONDS
    changed = changes.changes_of(options)
    request = RunRequest(
        files=[path],
        arguments=options.arguments,
        changes=changed,
        clock="virtual",
        seconds=seconds,
        calls=options.calls,
        lines=options.lines,
    )
    given = inputs.words(options.calls, options.lines)
    different = changes.words(changed)
    ways = (
        ("cbtui", "run", options.target, "--for", f"{seconds:.12g}", *given, *different),
        ("cbtui", "open", options.target, *different),
    )
    replays = [ReplayCommand(words, tuple(options.arguments)) for words in ways]
    return Exploration(request.setup(), path.name, None, options.limit), replays


def _of_lesson(options: argparse.Namespace) -> "tuple[Exploration, list[ReplayCommand]]":
    from cbtui.runs.judged.exploration_text import ReplayCommand

    lesson = lesson_of(options.target, or_file=True)
    if lesson.setup.clock == "real":
        refuse(f"{lesson.id} runs on the real clock, where the machine alone chooses the order of threads")
    run = lesson.run
    words = ["cbtui", "run", lesson.id, "--for", f"{run.seconds:g}"]
    words += [] if run.threads is None else ["--threads", str(run.threads)]
    words += inputs.words(run.calls, sorted(run.lines))
    replays = [ReplayCommand(tuple(words)), ReplayCommand(("cbtui", "open", lesson.id))]
    return _judged(lesson, options, None), replays


def _judged(lesson: "Lesson", options: argparse.Namespace, file: str | None) -> "Exploration":
    """Return the exploration of a lesson's node, or of a file in its place, judged by the lesson's checks."""
    from cbtui.runs.judged.exploring import Exploration
    from cbtui.runs.setup.lesson_setup import setup_to_judge
    from lessons.judge import Judge

    judge = None if lesson.exercise is None else Judge(lesson)
    path = None if file is None else file_of(file)
    name = lesson.node_path.name if path is None else path.name
    return Exploration(setup_to_judge(lesson, path), name, judge, options.limit)
