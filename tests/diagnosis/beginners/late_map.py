import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String


class MapServer(Node):
    def __init__(self):
        super().__init__("map_server")
        self.publisher = self.create_publisher(String, "map", 1)
        self.publisher.publish(String(data="the map"))


class Planner(Node):
    def __init__(self):
        super().__init__("planner")
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.create_subscription(String, "map", self.on_map, latched)

    def on_map(self, message):
        self.get_logger().info(message.data)


def main():
    rclpy.init()
    executor = rclpy.executors.SingleThreadedExecutor()
    for node in (MapServer(), Planner()):
        executor.add_node(node)
    executor.spin()


if __name__ == "__main__":
    main()
