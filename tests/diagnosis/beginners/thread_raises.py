import threading
import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float32


class Camera(Node):
    def __init__(self):
        super().__init__("camera")
        self.publisher = self.create_publisher(Float32, "exposure", 10)
        self.n = 0
        threading.Thread(target=self.grab, daemon=True).start()
        self.create_timer(1.0, self.report)

    def grab(self):
        while rclpy.ok():
            time.sleep(0.3)
            self.n += 1
            self.publisher.publish(Float32(data=10.0 / (3 - self.n)))

    def report(self):
        self.get_logger().info(f"{self.n} pictures")


def main():
    rclpy.init()
    rclpy.spin(Camera())


if __name__ == "__main__":
    main()
