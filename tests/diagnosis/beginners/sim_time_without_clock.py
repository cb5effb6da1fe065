import rclpy
from rclpy.node import Node
from rclpy.parameter import Parameter


class T(Node):
    def __init__(self):
        super().__init__("sim_node", parameter_overrides=[Parameter("use_sim_time", value=True)])
        self.create_timer(0.5, self.tick)

    def tick(self):
        self.get_logger().info("tick")


def main():
    rclpy.init()
    rclpy.spin(T())


if __name__ == "__main__":
    main()
