"""Rules that find out from a timeline why callbacks do not run as intended, and what to do about it."""

from sim.diagnosis.diagnoses import Diagnoses, diagnose
from sim.diagnosis.rule import CodeLocation, Explanation, Finding, Rule, Weight
from sim.diagnosis.rules import RULES
from sim.diagnosis.text import findings_text, location_text, sentence
from sim.diagnosis.timeline_view import TimelineView

__all__ = [
    "RULES",
    "Diagnoses",
    "Explanation",
    "Finding",
    "TimelineView",
    "CodeLocation",
    "Rule",
    "Weight",
    "diagnose",
    "findings_text",
    "sentence",
    "location_text",
]
