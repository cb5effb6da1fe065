"""Finds, starts, runs and ends the programs of a run as CPython and ROS 2 do."""
