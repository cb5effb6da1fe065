"""Imports and builds what most engines need, in the process that engines are forked from."""

import sim.engine.process
import sim.robot.bullet_physics
import sim.robot.driver
import sim.robot.model_port
import sim.robot.world
import sim.ros.actions
import sim.ros.internals.compiled
import sim.ros.lifecycle
import sim.ros.node  # noqa: F401
from sim.interfaces import message, names, service
from sim.interfaces.jazzy import jazzy_tables
from sim.ros.importing import import_all_of

jazzy_tables()
import_all_of("sim.ros.rclpy")
for name in names("rcl_interfaces", "srv"):
    service("rcl_interfaces", name)
service("type_description_interfaces", "GetTypeDescription")
service("std_srvs", "SetBool")
for package, name in (("rcl_interfaces", "Log"), ("sensor_msgs", "LaserScan"), ("nav_msgs", "Odometry")):
    message(package, name)
