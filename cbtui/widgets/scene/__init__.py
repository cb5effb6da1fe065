"""Scenes: small figures that move as the callbacks of a lesson do."""

from cbtui.widgets.scene.painter import paint_scene

__all__ = ["paint_scene"]
