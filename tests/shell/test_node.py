"""``ros2 node``: which nodes are shown, and with what."""

from sim.interfaces import message, service
from sim.ros.node.node import Node
from tests.shell.lines import carry_out, own
from tests.support.simulation import Simulation

Int32 = message("std_msgs", "Int32")
SetBool = service("std_srvs", "SetBool")


def two_nodes(_: Simulation) -> None:
    """A node with one of each, and one in a namespace."""
    node = Node("sub_node", start_parameter_services=False)
    node.create_publisher(Int32, "/out", 10)
    node.create_subscription(Int32, "/in", lambda _: None, 10)
    node.create_client(SetBool, "/ask")
    Node("helper", namespace="/a")


def test_nodes_are_listed_without_the_hidden_one_that_looks() -> None:
    assert carry_out("node list", two_nodes).out == "/a/helper\n/sub_node\n"
    assert carry_out("node list -a", two_nodes).out == "/_ros2cli_1\n/a/helper\n/sub_node\n"
    assert carry_out("node list -c", two_nodes).out == "2\n"


def test_nodes_that_share_a_name_are_warned_of() -> None:
    result = carry_out("node list", lambda _: (Node("n"), Node("n")))
    assert result.err == (
        "WARNING: Be aware that there are nodes in the graph that share an exact name, "
        "which can have unintended side effects.\n"
    )
    assert result.out == "/n\n/n\n"


def test_info_tells_all_that_a_node_has() -> None:
    out = own(carry_out("node info /sub_node", two_nodes).out)
    assert out == (
        "/sub_node\n"
        "  Subscribers:\n"
        "    /in: std_msgs/msg/Int32\n"
        "  Publishers:\n"
        "    /out: std_msgs/msg/Int32\n"
        "  Service Servers:\n"
        "    /sub_node/get_type_description: type_description_interfaces/srv/GetTypeDescription\n"
        "  Service Clients:\n"
        "    /ask: std_srvs/srv/SetBool\n"
        "  Action Servers:\n"
        "\n"
        "  Action Clients:\n"
        "\n"
    )


def test_an_unknown_node_is_said_as_ros2_says_it() -> None:
    result = carry_out("node info /nobody", two_nodes)
    assert (result.err, result.status) == ("Unable to find node '/nobody'\n", 1)
