"""The robot and its surroundings."""

from sim.trace.events.event import TraceEvent
from sim.trace.events.fields import MessageId, Metres, MetresPerSecond, Radians, RadiansPerSecond, Ranges


class ArenaShown(TraceEvent, frozen=True, tag="arena"):
    """The robot's surroundings."""

    walls: tuple[tuple[float, float, float, float], ...]
    """Walls as x0, y0, x1 and y1 each, in metres."""
    sphere: tuple[float, float, float]
    """Obstacle as x, y and radius, in metres."""
    robot_radius: Metres
    """Distance from the middle of the robot to its rim; 0 once it has left the run."""


class RobotMoved(TraceEvent, frozen=True, tag="robot"):
    """Position and velocity of the robot."""

    x: Metres
    """Position in the arena."""
    y: Metres
    """Position in the arena."""
    yaw: Radians
    """Direction, counter-clockwise from the x axis."""
    front: Metres
    """Distance to the next obstacle straight ahead, infinite if none is in range."""
    linear: MetresPerSecond
    """Velocity of the robot."""
    angular: RadiansPerSecond
    """Velocity of the robot."""
    motors: bool
    """Whether the wheels are powered."""
    touching: bool
    """Whether the robot touches something."""
    turned: Radians
    """Angle turned since the run began, counter-clockwise positive."""
    travelled: Metres
    """Distance driven since the run began."""


class Scanned(TraceEvent, frozen=True, tag="scan"):
    """The laser finished a full turn."""

    message: MessageId
    ranges: Ranges
    """How many ranges there are, and the one straight ahead in metres, ``null`` for nothing in range.

    On the wire: little-endian uint16 millimetres, 0 for nothing in range. Beam i points at -pi + i·2pi/n from
    straight ahead, counter-clockwise.
    """


VELOCITY_TOPIC = "/cmd_vel"
"""The topic on which the robot is told where to go."""

SENSOR_TOPICS = {"/odom": "nav_msgs/msg/Odometry", "/scan": "sensor_msgs/msg/LaserScan"}
"""The topics on which the robot publishes what it measures, and their types."""

ROBOT_SERVICES = ("/reset_world", "/motor_power")
"""The services that the robot offers."""

ROBOT_THREAD = "robot_driver"
"""The thread that drives it on the model."""


class VelocityCommanded(TraceEvent, frozen=True, tag="cmd_vel"):
    """The robot's driver took a velocity command."""

    linear: MetresPerSecond
    """Commanded velocity, after clamping."""
    angular: RadiansPerSecond
    """Commanded velocity, after clamping."""
