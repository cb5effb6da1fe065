import rclpy
from rclpy.node import Node
from std_msgs.msg import String


class Blinker(Node):
    def __init__(self):
        super().__init__("blinker")
        self.lamps = {}
        for colour in ("red", "green", "blue"):
            self.lamps[colour] = self.create_publisher(String, f"/led/{colour}", 10)
            self.create_timer(1.0, lambda: self.blink(colour))

    def blink(self, colour):
        self.lamps[colour].publish(String(data="on"))


def main():
    rclpy.init()
    rclpy.spin(Blinker())


if __name__ == "__main__":
    main()
