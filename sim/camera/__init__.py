"""Pictures of the robot's world: drawn by a process of their own, from what a trace tells."""

from sim.camera.camera import Camera
from sim.camera.wire import Picture, Shot

__all__ = ["Camera", "Picture", "Shot"]
