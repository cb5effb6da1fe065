"""Shows a process of real ROS 2 to the console: what its rclpy does, as events of ``sim.trace``.

It runs in the program's own Python, 3.10 or newer, where nothing else of cbtui need be installed, and uses
the standard library alone. What is on the program's path is ``..``; ``CBTUI_PROBE`` names the folder of the
sockets at which consoles find the processes.
"""

PROTOCOL = 1
"""What a console and a probe have to agree on."""

FOLDER = "CBTUI_PROBE"
"""The environment variable that names the folder of the sockets; without it the probe does nothing."""

CHANGES = "CBTUI_CHANGES"
"""The environment variable with what is to be changed about the program, as JSON."""

FOLLOW = b"follow\n"
"""What a console says that wants to be told what happens; until then it is only told which process it is."""

PORT = "CBTUI_PROBE_PORT"
"""The environment variable with a port of the loopback interface, for consoles of other machines."""

PORTS = 10
"""So many ports from that one on are tried, as each process needs its own."""

TOKEN = "CBTUI_PROBE_TOKEN"
"""The environment variable with what a console must say first there, on a line of its own."""
