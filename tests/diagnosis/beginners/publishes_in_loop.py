import time

import rclpy
from rclpy.node import Node
from std_msgs.msg import String


def hear(message):
    print(message.data)


def main():
    rclpy.init()
    node = Node("talker")
    pub = node.create_publisher(String, "chatter", 10)
    node.create_subscription(String, "chatter", hear, 10)
    n = 0
    while rclpy.ok():
        pub.publish(String(data=f"hello {n}"))
        n += 1
        time.sleep(0.5)


if __name__ == "__main__":
    main()
