"""The screen of a lesson, in layers: each file adds to the one that it builds on."""

from cbtui.screens.lesson.screen import FRAMES_A_SECOND, LessonScreen

__all__ = ["FRAMES_A_SECOND", "LessonScreen"]
