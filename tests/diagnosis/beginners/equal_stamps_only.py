import rclpy
from message_filters import Subscriber, TimeSynchronizer
from rclpy.node import Node
from sensor_msgs.msg import Image, LaserScan


class Fusion(Node):
    def __init__(self):
        super().__init__("fusion")
        self.camera = self.create_publisher(Image, "picture", 10)
        self.lidar = self.create_publisher(LaserScan, "scan", 10)
        self.create_timer(0.1, self.take)
        filters = [Subscriber(self, Image, "picture"), Subscriber(self, LaserScan, "scan")]
        self.sync = TimeSynchronizer(filters, 10)
        self.sync.registerCallback(self.fuse)

    def take(self):
        for publisher, message in ((self.camera, Image()), (self.lidar, LaserScan())):
            message.header.stamp = self.get_clock().now().to_msg()
            publisher.publish(message)
            self.get_clock().sleep_for(rclpy.duration.Duration(seconds=0.004))

    def fuse(self, picture, scan):
        self.get_logger().info("FUSED")


rclpy.init()
rclpy.spin(Fusion())
