import rclpy
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup
from rclpy.node import Node
from rclpy.task import Future
from std_msgs.msg import String


class Waiter(Node):
    def __init__(self):
        super().__init__("waiter")
        self.ready = Future()
        self.publisher = self.create_publisher(String, "start", 10)
        self.create_subscription(String, "start", self.on_start, 10)
        self.create_timer(0.5, self.tick, callback_group=MutuallyExclusiveCallbackGroup())
        self.create_timer(1.0, self.send)

    async def tick(self):
        await self.ready
        self.get_logger().info("ready")

    def send(self):
        self.publisher.publish(String(data="go"))

    def on_start(self, message):
        if message.data == "GO":
            self.ready.set_result(True)


def main():
    rclpy.init()
    rclpy.spin(Waiter())


if __name__ == "__main__":
    main()
