"""cv_bridge: pictures as arrays."""

from pathlib import Path

import numpy as np

from sim.ros_packages.cv_bridge.colours import convert
from sim.ros_packages.cv_bridge.encodings import Encoding, encoding_of
from tests.ros_packages.node_programs import printed


def known(name: str) -> Encoding:
    found = encoding_of(name)
    assert found is not None
    return found


def test_pictures_go_through_a_topic(tmp_path: Path) -> None:
    said = printed(
        tmp_path,
        """
        import numpy as np
        import rclpy
        from cv_bridge import CvBridge
        from rclpy.node import Node
        from sensor_msgs.msg import Image
        from std_msgs.msg import Header

        bridge = CvBridge()

        class Camera(Node):
            def __init__(self):
                super().__init__("camera")
                self.publisher = self.create_publisher(Image, "image_raw", 10)
                frame = np.zeros((2, 3, 3), dtype=np.uint8)
                frame[0, 1] = (255, 128, 0)  # blue, green, red
                self.message = bridge.cv2_to_imgmsg(frame, encoding="bgr8", header=Header(frame_id="eye"))
                self.create_timer(0.1, lambda: self.publisher.publish(self.message))

        class Viewer(Node):
            def __init__(self):
                super().__init__("viewer")
                self.create_subscription(Image, "image_raw", self.look, 10)
            def look(self, message):
                print(message.header.frame_id, message.encoding, message.height, message.width, message.step)
                print(bridge.imgmsg_to_cv2(message)[0, 1].tolist())
                print(bridge.imgmsg_to_cv2(message, desired_encoding="rgb8")[0, 1].tolist())
                grey = bridge.imgmsg_to_cv2(message, "mono8")
                print(grey.shape, grey[0, 1])
                raise SystemExit

        rclpy.init()
        executor = rclpy.executors.SingleThreadedExecutor()
        executor.add_node(Camera())
        executor.add_node(Viewer())
        executor.spin()
        """,
    )
    assert said == ["eye bgr8 2 3 9", "[255, 128, 0]", "[0, 128, 255]", "(2, 3) 104"]


def test_depth_keeps_its_numbers_and_what_makes_no_sense_is_told(tmp_path: Path) -> None:
    said = printed(
        tmp_path,
        """
        import numpy as np
        from cv_bridge import CvBridge, CvBridgeError
        bridge = CvBridge()
        depth = np.array([[0.5, np.nan], [1.5, 2.5]], dtype=np.float32)
        message = bridge.cv2_to_imgmsg(depth)
        again = bridge.imgmsg_to_cv2(message)
        print(message.encoding, message.step, np.array_equal(again, depth, equal_nan=True))
        millimetres = bridge.cv2_to_imgmsg(np.array([[1000, 65535]], dtype=np.uint16), "16UC1")
        print(bridge.imgmsg_to_cv2(millimetres, "passthrough").tolist())
        print(bridge.encoding_to_dtype_with_channels("8UC3"), bridge.encoding_to_cvtype2("bgr8"))
        print(bridge.cvtype2_to_dtype_with_channels(16), bridge.dtype_with_channels_to_cvtype2("uint8", 3))
        def wrong(deed):
            try:
                deed()
            except TypeError as error:
                print(type(error).__name__, error)
        wrong(lambda: bridge.imgmsg_to_cv2(message, "bgr8"))
        wrong(lambda: bridge.imgmsg_to_cv2(message, "16UC1"))
        wrong(lambda: bridge.imgmsg_to_cv2(message, "brg8"))
        wrong(lambda: bridge.cv2_to_imgmsg(depth, "bgr8"))
        wrong(lambda: bridge.cv2_to_imgmsg([[1]]))
        message.data = message.data[:5]
        wrong(lambda: bridge.imgmsg_to_cv2(message))
        wrong(lambda: bridge.compressed_imgmsg_to_cv2(None))
        """,
    )
    assert said == [
        "32FC1 8 True",
        "[[1000, 65535]]",
        "('uint8', 3) 16",
        "('uint8', 3) 8UC3",
        "CvBridgeError [32FC1] is not a color format. but [bgr8] is. The conversion does not make sense",
        "CvBridgeError Unsupported conversion from [32FC1] to [16UC1]",
        "CvBridgeError Unrecognized image encoding [brg8]",
        "CvBridgeError encoding specified as bgr8, but image has incompatible type 32FC1",
        "TypeError Your input type is not a numpy array",
        "CvBridgeError the image has 2 rows of 8 bytes, and 5 bytes of data",
        "CvBridgeError compressed images need OpenCV's decoders, which are not here; send "
        "sensor_msgs/msg/Image, or decode message.data with cv2.imdecode() or PIL",
    ]


def test_colours_become_others() -> None:
    picture = np.array([[[10, 20, 30], [0, 0, 255]]], dtype=np.uint8)
    assert convert(picture, known("rgb8"), known("bgra8")).tolist() == [[[30, 20, 10, 255], [255, 0, 0, 255]]]
    assert convert(picture, known("rgb8"), known("mono8")).tolist() == [[18, 29]]
    assert convert(picture, known("rgb8"), known("rgb16"))[0, 1].tolist() == [0, 0, 65535]
    grey = np.array([[7]], dtype=np.uint8)
    assert convert(grey, known("mono8"), known("bgr8")).tolist() == [[[7, 7, 7]]]
    assert convert(grey, known("mono8"), known("mono16")).tolist() == [[7 * 257]]
