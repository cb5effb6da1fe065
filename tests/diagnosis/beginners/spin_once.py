import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Bool


class Door(Node):
    def __init__(self):
        super().__init__("door")
        self.opened = None
        self.publisher = self.create_publisher(Bool, "open", 10)
        self.create_subscription(Bool, "open", self.on_open, 10)
        self.create_timer(0.5, self.go)

    def on_open(self, message):
        self.opened = message.data

    def go(self):
        self.opened = None
        self.publisher.publish(Bool(data=True))
        while self.opened is None:
            rclpy.spin_once(self)
        self.get_logger().info("through")


def main():
    rclpy.init()
    executor = SingleThreadedExecutor()
    executor.add_node(Door())
    executor.spin()


if __name__ == "__main__":
    main()
