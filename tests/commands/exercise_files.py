"""Files that learners hand in: the lesson's own, and some that are no use."""

from lessons.catalogue import find

LESSON = find("split-groups")
assert LESSON.starter_path is not None
assert LESSON.solution_path is not None
STARTER = LESSON.starter_path.read_text()
SOLUTION = LESSON.solution_path.read_text()
ENDLESS_CALLBACK = STARTER.replace("time.sleep(1)", "while True: pass")
ENDLESS_MAIN = "import rclpy\nrclpy.init()\nwhile rclpy.ok():\n    pass\n"
NEVER_SPINS = """
import time
import rclpy
rclpy.init()
node = rclpy.create_node("lazy")
while rclpy.ok():
    time.sleep(0.1)
"""
A_GIGABYTE = "while True:\n    print('x' * 1_000_000)\n"
SYNTAX_ERROR = STARTER.replace("class SphereAvoider(Node):", "class SphereAvoider(Node)")
LEAVES = "import os\nos._exit(3)\n"
