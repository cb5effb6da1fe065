"""The commands of ``ros2`` that are modelled, and those that need a ROS 2 machine."""

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
"""Commands of ``ros2`` that are not modelled."""


def listed() -> str:
    """Return the modelled commands as an enumeration."""
    return f"{', '.join(COMMANDS[:-1])} and {COMMANDS[-1]}"
