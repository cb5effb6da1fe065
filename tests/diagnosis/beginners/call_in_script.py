import rclpy
from std_srvs.srv import Trigger

rclpy.init()
node = rclpy.create_node("plain")
client = node.create_client(Trigger, "/ping")


def pong(request, response):
    response.success = True
    return response


def ask():
    reply = client.call(Trigger.Request())
    node.get_logger().info(f"{reply.success}")


service = node.create_service(Trigger, "/ping", pong)
timer = node.create_timer(0.5, ask)
rclpy.spin(node)
