import threading
import time

import rclpy
from rclpy.node import Node


class Holder(Node):
    def __init__(self):
        super().__init__("holder")
        self.lock = threading.Lock()
        self.value = 0
        threading.Thread(target=self.poll, daemon=True).start()
        self.create_timer(0.5, self.show)

    def poll(self):
        while rclpy.ok():
            self.lock.acquire()
            self.value += 1
            if self.value == 4:
                return
            self.lock.release()
            time.sleep(0.2)

    def show(self):
        with self.lock:
            self.get_logger().info(f"value {self.value}")


def main():
    rclpy.init()
    rclpy.spin(Holder())


if __name__ == "__main__":
    main()
