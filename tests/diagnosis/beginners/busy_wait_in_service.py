import rclpy
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from std_msgs.msg import Bool
from std_srvs.srv import Trigger


class Gripper(Node):
    def __init__(self):
        super().__init__("gripper")
        self.closed = False
        self.pub = self.create_publisher(Bool, "closed", 10)
        self.create_subscription(Bool, "closed", self.on_closed, 10)
        self.create_service(Trigger, "close", self.close)
        self.client = self.create_client(Trigger, "close")
        self.create_timer(0.5, self.ask)

    def ask(self):
        self.client.call_async(Trigger.Request())

    def on_closed(self, message):
        self.closed = message.data

    def close(self, request, response):
        self.pub.publish(Bool(data=True))
        while not self.closed:
            pass
        response.success = True
        self.get_logger().info("closed")
        return response


def main():
    rclpy.init()
    executor = MultiThreadedExecutor(num_threads=4)
    executor.add_node(Gripper())
    executor.spin()


if __name__ == "__main__":
    main()
