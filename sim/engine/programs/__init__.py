"""The programs of a run: found, started, run and ended as CPython and ROS 2 do."""
