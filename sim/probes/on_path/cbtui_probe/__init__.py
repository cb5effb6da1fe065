"""The probe: reports what rclpy does in a process of real ROS 2, as events of ``sim.trace``.

It runs in the program's own Python, 3.10 or newer, uses only the standard library, and needs nothing else of
cbtui there. The folder above this one is on the program's ``PYTHONPATH``. ``CBTUI_PROBE`` names the folder
with the sockets to which consoles connect.
"""

PROTOCOL = 1
"""The version of the protocol between console and probe."""

FOLDER = "CBTUI_PROBE"
"""The environment variable with the folder of the sockets; without it the probe does nothing."""

CHANGES = "CBTUI_CHANGES"
"""The environment variable with the changes to apply to the program, as JSON."""

FOLLOW = b"follow\n"
"""The request for the event stream; a console that has not sent it gets only the process's description."""

PORT = "CBTUI_PROBE_PORT"
"""The environment variable with a loopback port, for consoles on other machines."""

PORTS = 10
"""How many ports from that one on are tried: each process needs its own."""

TOKEN = "CBTUI_PROBE_TOKEN"
"""The environment variable with the token that a console must send first on that port, as one line."""
