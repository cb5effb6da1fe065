"""Rules over a timeline that tell why callbacks do not run as meant, and what to do about it."""

from sim.diagnosis.diagnoses import Diagnoses, diagnose
from sim.diagnosis.look import Look
from sim.diagnosis.rule import Explanation, Finding, Place, Rule, Weight
from sim.diagnosis.rules import RULES
from sim.diagnosis.text import findings_text, sentence, whereabouts

__all__ = [
    "RULES",
    "Diagnoses",
    "Explanation",
    "Finding",
    "Look",
    "Place",
    "Rule",
    "Weight",
    "diagnose",
    "findings_text",
    "sentence",
    "whereabouts",
]
