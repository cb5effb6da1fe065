import rclpy
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.node import Node
from std_msgs.msg import String


class Talker(Node):
    def __init__(self):
        super().__init__("talker")
        self.chatter = self.create_publisher(String, "chatter", 10)
        self.timer = self.create_timer(0.5, self.talk, callback_group=ReentrantCallbackGroup)

    def talk(self):
        self.chatter.publish(String(data="hello"))


def main():
    rclpy.init()
    rclpy.spin(Talker())


if __name__ == "__main__":
    main()
