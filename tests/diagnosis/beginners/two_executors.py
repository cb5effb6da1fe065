import rclpy
from rclpy.executors import SingleThreadedExecutor
from std_msgs.msg import String

rclpy.init()
camera = rclpy.create_node("camera")
viewer = rclpy.create_node("viewer")
pub = camera.create_publisher(String, "image", 10)
timer = camera.create_timer(0.5, lambda: pub.publish(String(data="image")))


def show(msg):
    viewer.get_logger().info(f"shows {msg.data}")


sub = viewer.create_subscription(String, "image", show, 10)
camera_executor = SingleThreadedExecutor()
camera_executor.add_node(camera)
viewer_executor = SingleThreadedExecutor()
viewer_executor.add_node(viewer)
camera_executor.spin()
viewer_executor.spin()
