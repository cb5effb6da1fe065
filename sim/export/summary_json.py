"""A run's summary and diagnosis as one object of JSON, for programs that read them. Times are seconds."""

from collections.abc import Iterator
from typing import Any

import msgspec

from sim.diagnosis import diagnose
from sim.quantities.nanoseconds import SECOND
from sim.trace.figures.summary import CallbackFigures, Summary, summarise
from sim.trace.timeline import Timeline


def summary_json(timeline: Timeline) -> bytes:
    """The summary of a whole timeline, with a newline at its end."""
    found = {**_figures(summarise(timeline)), "findings": list(_findings(timeline))}
    return msgspec.json.format(msgspec.json.encode(found), indent=1) + b"\n"


def _figures(summary: Summary) -> dict[str, Any]:
    robot = summary.robot
    return {
        "run": summary.target,
        "clock": summary.clock,
        "seconds": summary.length / SECOND,
        "ending": summary.ending,
        "lost_events": summary.lost,
        "threads_used": summary.threads_used,
        "threads_at_once": summary.threads_at_once,
        "callbacks": [_callback(each) for each in summary.callbacks],
        "services": [
            {
                "service": each.service,
                "calls": each.calls,
                "round_trips": [length / SECOND for length in each.round_trips],
            }
            for each in summary.services
        ],
        "robot": None if robot is None else msgspec.to_builtins(robot),
    }


def _callback(figures: CallbackFigures) -> dict[str, Any]:
    wait = figures.longest_wait
    return {
        "callback": figures.name,
        "kind": figures.entity.kind,
        "group": figures.group,
        "calls": figures.calls,
        "running": figures.running,
        "late": figures.late / SECOND,
        "drops": figures.drops,
        "errors": figures.errors,
        "longest_wait": 0.0 if wait is None else wait.length / SECOND,
        "waited_for": "" if wait is None else wait.why,
    }


def _findings(timeline: Timeline) -> Iterator[dict[str, Any]]:
    for found in diagnose(timeline):
        told = found.explained(timeline)
        yield {
            "rule": found.rule.id,
            "weight": found.weight_in(timeline).value,
            "what": told.what,
            "why": told.why,
            "cure": told.cure,
            "file": told.place and told.place.file,
            "line": told.place and told.place.first_line,
            "at": found.at / SECOND,
        }
