"""``rclpy.experimental``, as programs import it."""

from sim.ros.scheduling.events_executor import EventsExecutor as EventsExecutor
