import rclpy
from rclpy.executors import SingleThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Int32


class Source(Node):
    def __init__(self):
        super().__init__("source")
        self.publisher = self.create_publisher(Int32, "parts", 10)
        self.create_timer(0.5, self.send)

    def send(self):
        for number in range(5):
            self.publisher.publish(Int32(data=number))


class Counter(Node):
    def __init__(self):
        super().__init__("counter")
        self.seen = 0
        self.create_subscription(Int32, "parts", self.count, 2)

    def count(self, message):
        self.seen += 1


def main():
    rclpy.init()
    executor = SingleThreadedExecutor()
    executor.add_node(Source())
    executor.add_node(Counter())
    executor.spin()


if __name__ == "__main__":
    main()
