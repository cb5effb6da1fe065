"""Fuse what a camera and a lidar see at the same time.

Both send, both are heard. A TimeSynchronizer wants equal stamps, and
each sensor stamps the moment at which it measured.
"""

import message_filters
import rclpy
from rclpy.duration import Duration
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.time import Time
from sensor_msgs.msg import Image, LaserScan
from std_srvs.srv import SetBool

EXPOSURE = Duration(seconds=0.03)  # a picture is older than its message


def seconds_of(msg):
    """The stamp of a message, in seconds of the last hundred."""
    return Time.from_msg(msg.header.stamp).nanoseconds / 1e9 % 100


class Sensors(Node):
    """A camera at 10 Hz and a lidar at 4 Hz."""

    def __init__(self):
        super().__init__("sensors")
        self.camera = self.create_publisher(Image, "/picture", 10)
        self.lidar = self.create_publisher(LaserScan, "/scanned", 10)
        self.camera_timer = self.create_timer(0.1, self.take_picture)
        self.lidar_timer = self.create_timer(0.25, self.take_scan)
        self.srv = self.create_service(
            SetBool, "/sensors", self.sensors_callback
        )
        self.picture = Image()
        self.scan = LaserScan()

    def take_picture(self):
        self.picture = Image()
        measured = self.get_clock().now() - EXPOSURE
        self.picture.header.stamp = measured.to_msg()
        self.camera.publish(self.picture)

    def take_scan(self):
        self.scan = LaserScan()
        self.scan.header.stamp = self.get_clock().now().to_msg()
        self.lidar.publish(self.scan)

    def sensors_callback(self, _request, response):
        """Tell the last stamps, whether true or false was sent."""
        picture, scan = seconds_of(self.picture), seconds_of(self.scan)
        response.success = True
        response.message = f"picture {picture:.3f} s, scan {scan:.3f} s"
        self.get_logger().info(response.message)
        return response


class Fusion(Node):
    """Brings a picture and a scan of the same moment together."""

    def __init__(self):
        super().__init__("fusion")
        picture_sub = message_filters.Subscriber(self, Image, "/picture")
        scan_sub = message_filters.Subscriber(self, LaserScan, "/scanned")
        # Keeps the last ten of each, until two have one stamp.
        self.sync = message_filters.TimeSynchronizer(
            [picture_sub, scan_sub], 10
        )
        self.sync.registerCallback(self.fuse)

    def fuse(self, picture, scan):
        apart = abs(seconds_of(picture) - seconds_of(scan))
        self.get_logger().info(f"FUSED, {apart:.3f} s apart")


def main(args=None):
    rclpy.init(args=args)
    executor = SingleThreadedExecutor()
    nodes = [Sensors(), Fusion()]
    for node in nodes:
        executor.add_node(node)
    try:
        executor.spin()
    except (KeyboardInterrupt, ExternalShutdownException):
        pass  # Ctrl-C is the usual way to end a node
    finally:
        executor.shutdown()
        for node in nodes:
            node.destroy_node()
        rclpy.try_shutdown()


if __name__ == "__main__":
    main()
