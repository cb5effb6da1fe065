from concurrent.futures import ThreadPoolExecutor

import rclpy
from rclpy.node import Node
from std_msgs.msg import Float32


class Camera(Node):
    def __init__(self):
        super().__init__("camera")
        self.publisher = self.create_publisher(Float32, "exposure", 10)
        self.pool = ThreadPoolExecutor(1)
        self.n = 0
        self.create_timer(1.0, self.grab)

    def grab(self):
        self.pool.submit(self.work)

    def work(self):
        self.n += 1
        self.publisher.publish(Float32(data=10.0 / (2 - self.n)))


def main():
    rclpy.init()
    rclpy.spin(Camera())


if __name__ == "__main__":
    main()
