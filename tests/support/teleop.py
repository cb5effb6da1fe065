"""Programs that read from the keyboard, as learners write them."""

TELEOP = """
import select, sys, termios, tty

import rclpy
from geometry_msgs.msg import Twist

SPEEDS = {'w': (0.02, 0.0), 'x': (-0.02, 0.0), 'a': (0.0, 0.2), 'd': (0.0, -0.2)}


def get_key(settings):
    tty.setraw(sys.stdin.fileno())
    rlist, _, _ = select.select([sys.stdin], [], [], 0.1)
    key = sys.stdin.read(1) if rlist else ''
    termios.tcsetattr(sys.stdin, termios.TCSADRAIN, settings)
    return key


def main():
    settings = termios.tcgetattr(sys.stdin)
    rclpy.init()
    node = rclpy.create_node('teleop_keyboard')
    publisher = node.create_publisher(Twist, 'cmd_vel', 10)
    linear = angular = 0.0
    print('w a s d x move the robot, CTRL-C quits')
    while (key := get_key(settings)) != '\\x03':
        if key == 's':
            linear = angular = 0.0
        elif key in SPEEDS:
            linear, angular = linear + SPEEDS[key][0], angular + SPEEDS[key][1]
        if key:
            print(f'linear {linear:.2f}, angular {angular:.2f}')
        twist = Twist()
        twist.linear.x, twist.angular.z = linear, angular
        publisher.publish(twist)
    publisher.publish(Twist())
    rclpy.shutdown()


main()
"""
"""The keyboard teleop of nearly every course: one key at a time, with a timeout."""

ASKING = """
import threading

import rclpy
from rclpy.node import Node

class Ticking(Node):
    def __init__(self):
        super().__init__('ticking')
        self.create_timer(0.5, self.tick)

    def tick(self):
        self.get_logger().info('tick')

rclpy.init()
threading.Thread(target=rclpy.spin, args=(Ticking(),), daemon=True).start()
while (text := input('speed? ')) != 'q':
    print('the speed is', float(text))
"""
"""Asks for a line beside a node that spins."""
