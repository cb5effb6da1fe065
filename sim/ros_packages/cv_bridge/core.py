"""``cv_bridge.core``: converts ``sensor_msgs/Image`` messages to numpy arrays and back."""

import sys
from typing import Any

import numpy as np
from sensor_msgs.msg import Image

from sim.ros_packages.cv_bridge.colours import convert
from sim.ros_packages.cv_bridge.encodings import TYPES, Encoding, encoding_of

__all__ = ["CvBridge", "CvBridgeError"]

_NO_OPENCV = (
    "compressed images need OpenCV's decoders, which are not here; send sensor_msgs/msg/Image, "
    "or decode message.data with cv2.imdecode() or PIL"
)


class CvBridgeError(TypeError):
    """An image cannot be converted."""


CvBridgeError.__module__ = "cv_bridge.core"


class CvBridge:
    """Converts images. As in OpenCV, an array has rows, columns and, if there are several, channels.

    Arrays share no memory with the message.
    """

    def __init__(self) -> None:
        self.cvtype_to_name = {
            place + (channels - 1) * 8: f"{name}C{channels}"
            for place, name in enumerate(TYPES)
            for channels in range(1, 5)
        }
        self.numpy_type_to_cvtype = {str(known): name for name, known in TYPES.items()}

    def encoding_to_dtype_with_channels(self, encoding: str) -> tuple[str, int]:
        """The numpy type and number of channels of an encoding; CvBridgeError if the encoding is unknown."""
        known = _known(encoding)
        return str(known.type), known.channels

    def encoding_to_cvtype2(self, encoding: str) -> int:
        """OpenCV's number for an encoding; CvBridgeError for an unknown encoding."""
        known = _known(encoding)
        return list(TYPES.values()).index(known.type) + (known.channels - 1) * 8

    def cvtype2_to_dtype_with_channels(self, cvtype: int) -> tuple[str, int]:
        """The numpy type and number of channels of one of OpenCV's numbers."""
        return str(list(TYPES.values())[cvtype % 8]), cvtype // 8 + 1

    def dtype_with_channels_to_cvtype2(self, dtype: Any, n_channels: int) -> str:
        """OpenCV's name for a numpy type and a number of channels, such as ``8UC3``."""
        return f"{self.numpy_type_to_cvtype[np.dtype(dtype).name]}C{n_channels}"

    def imgmsg_to_cv2(self, img_msg: Any, desired_encoding: str = "passthrough") -> Any:
        """Convert a message to an array, in ``desired_encoding`` unless that is ``passthrough``.

        Raises:
            CvBridgeError: an encoding is unknown, the conversion is not possible, or bytes are missing.
        """
        source = _known(img_msg.encoding)
        layout = source.type.newbyteorder(">" if img_msg.is_bigendian else "<")
        data = bytes(img_msg.data)
        if len(data) < img_msg.step * img_msg.height:
            raise CvBridgeError(
                f"the image has {img_msg.height} rows of {img_msg.step} bytes, and {len(data)} bytes of data"
            )
        shape = (img_msg.height, img_msg.width, source.channels)
        strides = (img_msg.step, layout.itemsize * source.channels, layout.itemsize)
        image = np.ndarray(shape, layout, data, strides=strides).astype(source.type)
        picture = image[..., 0] if source.channels == 1 else image
        if desired_encoding in {"passthrough", img_msg.encoding}:
            return picture
        wanted = _known(desired_encoding)
        if source.colour and wanted.colour:
            return convert(picture, source, wanted)
        if (source.type, source.channels) == (wanted.type, wanted.channels):
            return picture
        if wanted.colour and not source.colour:
            raise CvBridgeError(
                f"[{img_msg.encoding}] is not a color format. but [{desired_encoding}] is. "
                "The conversion does not make sense"
            )
        raise CvBridgeError(f"Unsupported conversion from [{img_msg.encoding}] to [{desired_encoding}]")

    def cv2_to_imgmsg(self, cvim: Any, encoding: str = "passthrough", header: Any = None) -> Any:
        """Convert an array to a message; ``encoding`` describes its channels and converts nothing.

        Raises:
            TypeError: ``cvim`` is not an array.
            CvBridgeError: the encoding is unknown, or has another type or number of channels.
        """
        if not isinstance(cvim, np.ndarray):
            raise TypeError("Your input type is not a numpy array")
        height, width, *more = cvim.shape
        channels = more[0] if more else 1
        cv_type = self.dtype_with_channels_to_cvtype2(cvim.dtype, channels)
        if encoding != "passthrough" and _known(encoding).cv_type != cv_type:
            raise CvBridgeError(
                f"encoding specified as {encoding}, but image has incompatible type {cv_type}"
            )
        made = Image() if header is None else Image(header=header)
        made.height, made.width = height, width
        made.encoding = cv_type if encoding == "passthrough" else encoding
        made.is_bigendian = int(
            cvim.dtype.byteorder == ">" or (cvim.dtype.byteorder == "=" and sys.byteorder == "big")
        )
        made.data.frombytes(cvim.tobytes())
        made.step = len(made.data) // made.height if made.height else 0
        return made

    def compressed_imgmsg_to_cv2(self, cmprs_img_msg: Any, desired_encoding: str = "passthrough") -> Any:
        """Not without OpenCV: raises CvBridgeError."""
        raise CvBridgeError(_NO_OPENCV)

    def cv2_to_compressed_imgmsg(self, cvim: Any, dst_format: str = "jpg") -> Any:
        """Not without OpenCV: raises CvBridgeError."""
        raise CvBridgeError(_NO_OPENCV)


def _known(name: str) -> Encoding:
    found = encoding_of(name)
    if found is None:
        raise CvBridgeError(f"Unrecognized image encoding [{name}]")
    return found
