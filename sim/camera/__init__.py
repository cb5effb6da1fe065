"""Pictures of the robot's world: drawn from a trace by a process of their own."""

from sim.camera.camera import Camera
from sim.camera.wire import Picture, Shot

__all__ = ["Camera", "Picture", "Shot"]
