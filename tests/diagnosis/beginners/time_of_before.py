import rclpy
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.time import Time
from rosgraph_msgs.msg import Clock as ClockMessage


class World(Node):
    def __init__(self):
        super().__init__("world")
        self.publisher = self.create_publisher(ClockMessage, "/clock", 10)
        self.ticks = 0
        self.create_timer(0.1, self.tick)

    def tick(self):
        self.ticks = self.ticks + 1 if self.ticks < 20 else 0
        self.publisher.publish(ClockMessage(clock=Time(nanoseconds=self.ticks * 10**8).to_msg()))


class Oven(Node):
    def __init__(self):
        super().__init__("oven", parameter_overrides=[Parameter("use_sim_time", value=True)])
        self.done_at = None
        self.create_timer(0.1, self.look, clock=Clock(clock_type=ClockType.STEADY_TIME))

    def look(self):
        now = self.get_clock().now()
        if self.done_at is None or now >= self.done_at:
            self.done_at = now + Duration(seconds=1.5)


rclpy.init()
executor = rclpy.executors.SingleThreadedExecutor()
for node in (World(), Oven()):
    executor.add_node(node)
executor.spin()
