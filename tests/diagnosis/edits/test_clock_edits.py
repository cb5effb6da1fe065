"""Edits of programs that keep times of a simulated clock."""

from sim.diagnosis.edits.clocks import follow_jumps
from tests.diagnosis.edits.edited_source import changed, node

TEXT = node(
    """
    def __init__(self):
        self.due = None
        self.heard: Time | None = None
        self.timer = self.create_timer(0.1, self.tick)  # ten times a second

    def tick(self):
        self.due = self.heard = self.get_clock().now()  # here
    """,
    "import rclpy\nfrom rclpy.clock import Clock",
)


def test_what_a_node_remembers_is_set_back_with_its_clock() -> None:
    assert changed(TEXT, follow_jumps, "due", "heard") == [
        "-from rclpy.clock import Clock",
        "+from rclpy.clock import Clock, JumpThreshold",
        "+from rclpy.duration import Duration",
        "+        self.jumps = self.get_clock().create_jump_callback(",
        "+            JumpThreshold(",
        "+                min_forward=None, min_backward=Duration(nanoseconds=-1), on_clock_change=False",
        "+            ),",
        "+            post_callback=self.on_jump,",
        "+        )",
        "+",
        "+    def on_jump(self, jump):",
        "+        if self.due is not None:",
        "+            self.due += jump.delta",
        "+        if self.heard is not None:",
        "+            self.heard += jump.delta",
    ]


def test_what_is_not_set_from_the_beginning_or_heard_of_already_is_left_alone() -> None:
    assert changed(TEXT, follow_jumps, "due", "spoken") is None
    assert changed(TEXT.replace("self.timer =", "self.jumps ="), follow_jumps, "due") is None
