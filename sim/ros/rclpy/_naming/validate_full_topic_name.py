"""``rclpy.validate_full_topic_name``, as programs import it."""

from sim.ros.exceptions import InvalidServiceNameException, InvalidTopicNameException
from sim.ros.naming.validation import validate_full_topic_name
