"""Checks on service calls and on the log."""

from lessons.checks.check import Check, Verdict
from lessons.checks.reading import requests_of, seconds
from sim.quantities.nanoseconds import nearest_ns
from sim.trace.events import EntityKind, Logged, Severity
from sim.trace.timeline import Timeline


def replies_within(service: str, limit: float) -> Check:
    """Every call of a service gets its answer within ``limit`` seconds."""
    most = nearest_ns(limit)
    expected = f"an answer within {seconds(most)}"

    def judge(run: Timeline) -> Verdict:
        calls = requests_of(run, service)
        if not calls:
            return Verdict(False, expected, "no call")
        for call in calls:
            if call.replied is None:
                waited = (
                    "nobody who took the request"
                    if call.lost
                    else f"no answer in {seconds(run.end - call.sent)}"
                )
                return Verdict(False, expected, waited, call.sent)
        slowest = max(calls, key=lambda call: (call.replied or 0) - call.sent)
        took = (slowest.replied or 0) - slowest.sent
        return Verdict(took <= most, expected, f"an answer after {seconds(took, limit)}", slowest.sent)

    return Check(f"{service} answers in time", judge)


def every_call_answered() -> Check:
    """Every service call of the run gets its answer, and its caller takes it; there is at least one."""
    expected = "an answer to each"

    def judge(run: Timeline) -> Verdict:
        calls = run.calls
        if not calls:
            return Verdict(False, expected, "no call")
        open_ = [call for call in calls if call.replied is None]
        if open_:
            seen = f"{len(open_)} of {len(calls)} without one, the first of {open_[0].service}"
            return Verdict(False, expected, seen, open_[0].sent)
        unread = _not_taken(run)
        left = [call for call in calls if call.id in unread]
        if left:
            seen = f"{len(left)} of {len(calls)} not taken by the caller, the first of {left[0].service}"
            return Verdict(False, expected, seen, left[0].sent)
        return Verdict(True, expected, f"{len(calls)} of {len(calls)} answered")

    return Check("every service call is answered", judge)


def _not_taken(run: Timeline) -> set[int]:
    """Return the calls whose replies are in a client's queue or wait for a thread at the end of a run."""
    last = run.moment(run.end)
    clients = (entity for entity in last.queues if run.entities[entity].kind is EntityKind.CLIENT)
    queued = {message.id for client in clients for message in last.queues[client].messages}
    return queued | {blocked.call for blocked in last.blocked.values()}


_ERRORS = (Severity.ERROR, Severity.FATAL)


def log_says(text: str, at_least: int = 1) -> Check:
    """The log has lines with a text in them; if too few, the last error that was logged is told."""
    expected = "such a line" if at_least == 1 else f"at least {at_least} such lines"

    def judge(run: Timeline) -> Verdict:
        lines = [line for line in run.logs if text in line.text]
        at, seen = lines[0].t if lines else None, str(len(lines)) if lines else "none"
        logged = (line for line in reversed(run.logs) if isinstance(line, Logged))
        error = next((line for line in logged if line.severity in _ERRORS), None)
        if len(lines) >= at_least or error is None:
            return Verdict(len(lines) >= at_least, expected, seen, at)
        return Verdict(False, expected, f"{seen}; but the error: {error.text}", error.t)

    return Check(f"the log says '{text}'", judge)


def log_never_says(text: str) -> Check:
    """No line of the log has a text in it."""

    def judge(run: Timeline) -> Verdict:
        line = next((line for line in run.logs if text in line.text), None)
        if line is None:
            return Verdict(True, "no such line", "none")
        return Verdict(False, "no such line", line.text, line.t)

    return Check(f"the log never says '{text}'", judge)
