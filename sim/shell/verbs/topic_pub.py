"""``ros2 topic pub``: publishes a message once, several times or without end."""

from __future__ import annotations

from argparse import Namespace

from sim.ros.entities.publisher import Publisher
from sim.ros.scheduling.task import Future
from sim.shell.graph import known_topics, type_of_given
from sim.shell.messages import NO_DICTIONARY, Outgoing, given_values, message_class
from sim.shell.parser import LineParser, nonnegative_int, positive_float
from sim.shell.qos_options import add_qos_options, chosen_qos
from sim.shell.session import CommandFailed, ShellSession
from sim.shell.verbs.interface import message_prototype
from sim.shell.verbs.verb import Verb, add_graph_options

_MATCH_POLL = 0.1
_POLLS_A_REPORT = 10
_SHORTEST_PERIOD = 1e-9
"""Seconds; without a pause between messages, virtual time would stand still."""


def _add_arguments(parser: LineParser) -> None:
    parser.argument(
        "topic_name", help="Name of the ROS topic to publish to (e.g. '/chatter')", completer=known_topics
    )
    parser.argument(
        "message_type",
        help="Type of the ROS message (e.g. 'std_msgs/String')",
        completer=type_of_given(known_topics, "msg"),
    )
    parser.argument(
        "values",
        nargs="?",
        default="{}",
        help='Values to fill the message with in YAML format (e.g. "data: Hello World"), otherwise the '
        "message will be published with default values",
        completer=message_prototype,
    )
    parser.add_argument(
        "-r",
        "--rate",
        metavar="N",
        type=positive_float,
        default=1.0,
        help="Publishing rate in Hz (default: 1)",
    )
    parser.add_argument(
        "-p",
        "--print",
        metavar="N",
        type=int,
        default=1,
        help="Only print every N-th published message (default: 1)",
    )
    count = parser.add_mutually_exclusive_group()
    count.add_argument("-1", "--once", action="store_true", help="Publish one message and exit")
    count.add_argument(
        "-t", "--times", type=nonnegative_int, default=0, help="Publish this number of times and then exit"
    )
    parser.add_argument(
        "-w",
        "--wait-matching-subscriptions",
        type=nonnegative_int,
        default=None,
        help="Wait until finding the specified number of matching subscriptions. Defaults to 1 when using "
        '"-1"/"--once"/"--times", otherwise defaults to 0.',
    )
    parser.add_argument(
        "--keep-alive",
        metavar="N",
        type=positive_float,
        default=0.1,
        help="Keep publishing node alive for N seconds after the last msg (default: 0.1)",
    )
    parser.add_argument("-n", "--node-name", help="Name of the created publishing node")
    add_qos_options(parser, "publish", "default")
    add_graph_options(parser)


def _pub(session: ShellSession, arguments: Namespace) -> None:
    cls = message_class(session.ground, arguments.message_type)
    values = given_values(arguments.values)
    if not isinstance(values, dict):
        raise CommandFailed(NO_DICTIONARY)
    if arguments.node_name is not None:
        session.make_node(arguments.node_name)
    publisher = session.node.create_publisher(cls, arguments.topic_name, chosen_qos(arguments))
    times = 1 if arguments.once else arguments.times
    wanted = arguments.wait_matching_subscriptions
    _wait_for_subscriptions(session, publisher, int(times != 0) if wanted is None else wanted)
    outgoing = Outgoing(cls, values)
    session.say("publisher: beginning loop")
    _Loop(session, publisher, outgoing, arguments.print, times).run(
        max(1.0 / arguments.rate, _SHORTEST_PERIOD)
    )
    session.sleep(arguments.keep_alive)


def _wait_for_subscriptions(session: ShellSession, publisher: Publisher, wanted: int) -> None:
    polls = 0
    while publisher.get_subscription_count() < wanted:
        if polls % _POLLS_A_REPORT == 0:
            session.say(f"Waiting for at least {wanted} matching subscription(s)...")
        polls += 1
        session.sleep(_MATCH_POLL)


class _Loop:
    """Publishes at once and then each period, ``times`` times (0: without end)."""

    def __init__(
        self, session: ShellSession, publisher: Publisher, outgoing: Outgoing, every: int, times: int
    ) -> None:
        self._session = session
        self._publisher = publisher
        self._outgoing = outgoing
        self._every = every
        self._times = times
        self._count = 0
        self._done: Future[None] = Future()

    def run(self, period: float) -> None:
        self._publish()
        if self._times != 1:
            self._session.node.create_timer(period, self._publish)
            self._session.spin(self._done)

    def _publish(self) -> None:
        if self._done.done():
            return
        self._outgoing.stamp(self._session.node.get_clock().now().to_msg())
        self._count += 1
        if self._every and self._count % self._every == 0:
            self._session.say(f"publishing #{self._count}: {self._outgoing.message!r}\n")
        self._publisher.publish(self._outgoing.message)
        if self._count == self._times:
            self._done.set_result(None)


PUB = Verb("pub", "Publish a message to a topic", _add_arguments, _pub)
