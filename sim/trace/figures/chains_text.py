"""A chain as plain text for a terminal: its latencies, its critical path, what cost most, and a plot."""

from collections.abc import Iterator, Sequence

from sim.quantities.durations import duration, timestamp
from sim.quantities.plural import counted
from sim.trace.figures.chains import Chain, ChainError, ChainRun, chain
from sim.trace.figures.statistics import distribution
from sim.trace.model import Nanoseconds
from sim.trace.timeline import Timeline

_COLUMNS, _ROWS = 60, 6
_EIGHTHS = " ▁▂▃▄▅▆▇█"
_MOST_COSTS = 5


def chain_text(found: Chain) -> str:
    """Return a chain as text, ending in a newline."""
    return "\n".join([*_lines(found), ""])


def chain_report(timeline: Timeline, names: Sequence[str]) -> str:
    """Return the text of a run's chain, or a sentence that says why there is none."""
    try:
        return chain_text(chain(timeline, names))
    except ChainError as error:
        return f"Chain {':'.join(names)}: {error}\n"


def _lines(found: Chain) -> Iterator[str]:
    yield f"Chain {' -> '.join(found.path)}"
    heads = ("least", "median", "95 %", "most")
    yield f"  {'latency':14}{'count':>7}{''.join(head.rjust(10) for head in heads)}"
    yield _figures("whole chain", found.whole_chain)
    yield _figures("last message", found.runs)
    without = found.inputs - len(found.whole_chain)
    unknown = found.outputs - len(found.runs)
    if without:
        yield f"  {without} of {counted(found.inputs, 'input')} led to no output"
    if unknown:
        yield f"  {unknown} of {counted(found.outputs, 'output')} came of no input"
    critical = found.critical
    if critical is None:
        return
    yield f"  critical path, from {timestamp(critical.input.at)} to {timestamp(critical.output.at)}:"
    for step in critical.steps:
        if step.length:
            sign = ">" if step is critical.longest_step else " "
            yield f"  {sign} {duration(step.length):>8}  {step.words}"
    yield f"  what cost most, in {counted(len(found.whole_chain), 'run')} of the whole chain:"
    for cost in found.costs[:_MOST_COSTS]:
        if cost.total:
            longest = f"{duration(cost.longest.length)} at {timestamp(cost.longest.start)}"
            yield f"    {duration(cost.total):>8}  {cost.longest.words}; longest {longest}"
    yield from _plot(found.whole_chain)


def _figures(name: str, runs: Sequence[ChainRun]) -> str:
    found = distribution(each.latency for each in runs)
    if found is None:
        return f"  {name:14}{0:>7}"
    cells = (found.least, found.median, found.p95, found.most)
    return f"  {name:14}{len(runs):>7}{''.join(duration(cell).rjust(10) for cell in cells)}"


def _plot(runs: Sequence[ChainRun]) -> Iterator[str]:
    """The latencies over the time of the outputs: the highest of each column."""
    start, end = runs[0].output.at, runs[-1].output.at
    most = max(each.latency for each in runs)
    if start == end or not most:
        return
    columns: list[Nanoseconds] = [0] * _COLUMNS
    for each in runs:
        place = (each.output.at - start) * (_COLUMNS - 1) // (end - start)
        columns[place] = max(columns[place], each.latency)
    yield "  latency of the whole chain over time"
    steps = len(_EIGHTHS) - 1
    heights = [-(-latency * _ROWS * steps // most) for latency in columns]
    for row in reversed(range(_ROWS)):
        cells = "".join(_EIGHTHS[min(max(height - row * steps, 0), steps)] for height in heights)
        label = duration(most) if row == _ROWS - 1 else ""
        yield f"  {label:>8} │{cells}".rstrip()
    yield f"  {'':8} └{'─' * _COLUMNS}"
    left, right = timestamp(start), timestamp(end)
    yield f"  {'':9}{left}{right.rjust(_COLUMNS + 1 - len(left))}"
