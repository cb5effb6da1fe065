import rclpy
from rclpy.node import Node
from std_srvs.srv import Trigger


class Door(Node):
    def __init__(self):
        super().__init__("door")
        self.create_service(Trigger, "bell", self.on_bell)
        self.client = self.create_client(Trigger, "bell")
        self.create_timer(0.5, self.ring)

    def ring(self):
        self.client.call_async(Trigger.Request())

    def on_bell(self, request):
        return Trigger.Response(success=True)


def main():
    rclpy.init()
    rclpy.spin(Door())


if __name__ == "__main__":
    main()
