"""The options that say on what a program runs: the model of rclpy, or real ROS 2."""

import argparse


def add_options(parser: argparse.ArgumentParser) -> None:
    """Give a command the options."""
    parser.add_argument(
        "--on",
        choices=("model", "ros2"),
        default="model",
        help="what runs the program: cbtui's model of rclpy, or real rclpy on the real clock (model)",
    )
    parser.add_argument(
        "--python",
        metavar="EXE",
        default="",
        help="the Python that has real rclpy, such as /usr/bin/python3 after sourcing ROS (cbtui's own)",
    )
