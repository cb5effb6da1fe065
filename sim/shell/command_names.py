"""Which commands of ``ros2`` are carried out here, and which belong to a ROS 2 machine."""

COMMANDS = ("action", "interface", "launch", "lifecycle", "node", "param", "pkg", "run", "service", "topic")

ELSEWHERE = (
    "bag",
    "component",
    "control",
    "daemon",
    "doctor",
    "extension_points",
    "extensions",
    "multicast",
    "plugin",
    "security",
    "test",
    "wtf",
)
"""Commands of ``ros2`` that are not carried out here."""


def listed() -> str:
    """The commands as a sentence names them."""
    return f"{', '.join(COMMANDS[:-1])} and {COMMANDS[-1]}"
