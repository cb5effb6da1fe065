"""Rules that find in a timeline why callbacks do not run as intended, with advice."""

from sim.diagnosis.diagnoses import Diagnoses, diagnose
from sim.diagnosis.rule import CodeLocation, Explanation, Finding, Weight
from sim.diagnosis.rules import RULES
from sim.diagnosis.text import findings_text, location_text, sentence, with_stop

__all__ = [
    "RULES",
    "CodeLocation",
    "Diagnoses",
    "Explanation",
    "Finding",
    "Weight",
    "diagnose",
    "findings_text",
    "sentence",
    "location_text",
    "with_stop",
]
