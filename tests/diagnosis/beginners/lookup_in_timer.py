import rclpy
from geometry_msgs.msg import TransformStamped
from rclpy.duration import Duration
from rclpy.node import Node
from tf2_ros import Buffer, TransformBroadcaster, TransformException, TransformListener


class Follow(Node):
    def __init__(self):
        super().__init__("follow")
        self.buf = Buffer()
        self.lis = TransformListener(self.buf, self)
        self.br = TransformBroadcaster(self)
        self.create_timer(0.1, self.send)
        self.create_timer(1.0, self.look)

    def send(self):
        t = TransformStamped()
        t.header.stamp = self.get_clock().now().to_msg()
        t.header.frame_id = "map"
        t.child_frame_id = "base"
        t.transform.rotation.w = 1.0
        self.br.sendTransform(t)

    def look(self):
        try:
            self.buf.lookup_transform("map", "base", self.get_clock().now(), Duration(seconds=2.0))
            self.get_logger().info("got it")
        except TransformException as e:
            self.get_logger().error(f"tf: {e}")


def main():
    rclpy.init()
    rclpy.spin(Follow())


if __name__ == "__main__":
    main()
