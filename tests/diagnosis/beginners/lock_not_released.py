import threading

import rclpy
from rclpy.node import Node


class Counter(Node):
    def __init__(self):
        super().__init__("counter")
        self.lock = threading.Lock()
        self.n = 0
        self.create_timer(0.3, self.tick)

    def tick(self):
        self.lock.acquire()
        self.n += 1
        if self.n > 2:
            return
        self.lock.release()


def main():
    rclpy.init()
    rclpy.spin(Counter())


if __name__ == "__main__":
    main()
