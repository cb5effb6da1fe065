import rclpy
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

FAST = QoSProfile(depth=5, reliability=ReliabilityPolicy.BEST_EFFORT)
SAFE = QoSProfile(
    depth=5, reliability=ReliabilityPolicy.RELIABLE, durability=DurabilityPolicy.TRANSIENT_LOCAL
)


class Talk(Node):
    def __init__(self):
        super().__init__("talk")
        self.pub = self.create_publisher(String, "chat", FAST)
        self.create_subscription(String, "chat", self.hear, SAFE)
        self.create_timer(0.5, self.tick)

    def tick(self):
        self.pub.publish(String(data="hi"))

    def hear(self, msg):
        self.get_logger().info(msg.data)


def main():
    rclpy.init()
    rclpy.spin(Talk())


if __name__ == "__main__":
    main()
