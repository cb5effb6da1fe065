"""The packages are imported on the model's rclpy, as in an engine, which this process forgets afterwards.

Otherwise they would be on a real rclpy where that is installed, and on none elsewhere.
"""

import importlib
import sys

from sim.interfaces import packages
from sim.ros.importing import HOMES, install

_finders, _modules = sys.meta_path[:], sys.modules.copy()
install()
for _name in ("cv_bridge.colours", "tf2_py.histories"):
    importlib.import_module(f"sim.ros_packages.{_name}")
sys.meta_path[:] = _finders
for _name in set(sys.modules) - set(_modules):
    if _name.partition(".")[0] in {*HOMES, *packages(), "rosidl_parser"}:
        del sys.modules[_name]
sys.modules.update(_modules)
