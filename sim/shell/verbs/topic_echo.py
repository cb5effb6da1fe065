"""``ros2 topic echo``: prints the messages of a topic."""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from sim.files import plain_yaml
from sim.interfaces.rosidl_runtime_py import message_to_csv, message_to_yaml
from sim.ros.scheduling.task import Future
from sim.shell.filters import add_filter_option, compiled_filter
from sim.shell.graph import full_topic_name, known_topics, topic_type, type_of_given
from sim.shell.messages import message_class
from sim.shell.parser import LineParser, positive_float, unsigned_int
from sim.shell.qos_options import add_qos_options, matching_qos
from sim.shell.session import CommandFailed, ShellSession
from sim.shell.verbs.verb import Verb, add_graph_options

if TYPE_CHECKING:
    from sim.ros.entities.message_info import MessageInfo

_DEFAULT_LENGTH = 128


def _add_arguments(parser: LineParser) -> None:
    parser.argument(
        "topic_name", help="Name of the ROS topic to listen to (e.g. '/chatter')", completer=known_topics
    )
    parser.argument(
        "message_type",
        nargs="?",
        help="Type of the ROS message (e.g. 'std_msgs/msg/String')",
        completer=type_of_given(known_topics),
    )
    add_qos_options(parser, "subscribe", "sensor_data")
    add_graph_options(parser)
    parser.flag("--csv", help="Output all recursive fields separated by commas (e.g. for plotting)")
    parser.add_argument(
        "--field",
        metavar="FIELD_NAME",
        help="Echo a selected field of a message. Use '.' to select sub-fields. For example, to echo the "
        "position field of a nav_msgs/msg/Odometry message: 'ros2 topic echo /odom --field "
        "pose.pose.position'",
    )
    parser.flag(
        "--full-length",
        "-f",
        help="Output all elements for arrays, bytes, and string with a length > '--truncate-length', by "
        "default they are truncated after '--truncate-length' elements with '...'",
    )
    parser.add_argument(
        "--truncate-length",
        "-l",
        type=unsigned_int,
        default=_DEFAULT_LENGTH,
        help="The length to truncate arrays, bytes, and string to (default: %(default)d)",
    )
    parser.flag("--no-arr", help="Don't print array fields of messages")
    parser.flag("--no-str", help="Don't print string fields of messages")
    parser.flag("--flow-style", help="Print collections in the block style")
    parser.flag("--no-lost-messages", help="Don't report when a message is lost")
    parser.flag("--raw", help="Echo the raw binary representation")
    add_filter_option(parser, "echo")
    parser.flag("--once", help="Print the first message received and then exit.")
    parser.add_argument(
        "--timeout", metavar="N", type=positive_float, help="Set a timeout in seconds for waiting"
    )
    parser.flag("--include-message-info", help="Shows the associated message info.")


def _echo(session: ShellSession, arguments: Namespace) -> None:
    kind = arguments.message_type or topic_type(session, arguments.topic_name)
    if kind is None:
        session.say(f"WARNING: topic [{arguments.topic_name}] does not appear to be published yet")
        raise CommandFailed("Could not determine the type for the passed topic")
    cls = message_class(session.ground, kind)
    qos = matching_qos(session, full_topic_name(session, arguments.topic_name), arguments)
    first: Future[None] = Future()
    listener = _Listener(session, arguments, first)
    session.node.create_subscription(cls, arguments.topic_name, listener.hear, qos, raw=arguments.raw)
    session.spin(first, arguments.timeout)


class _Listener:
    """Prints each message as the options say; ``first`` is done with the first message if one is enough."""

    def __init__(self, session: ShellSession, arguments: Namespace, first: Future[None]) -> None:
        self._shorter: dict[str, Any] = {
            "truncate_length": None if arguments.full_length else arguments.truncate_length,
            "no_arr": arguments.no_arr,
            "no_str": arguments.no_str,
        }
        self._session = session
        self._options = arguments
        self._fields = [each for each in (arguments.field or "").split(".") if each]
        self._passes: Callable[[Any], object] | None = compiled_filter(arguments.filter)
        self._first = first

    def hear(self, message: Any, info: MessageInfo) -> None:
        if self._first.done():
            return
        shown = self._selected(message)
        if self._passes is not None and not self._passes(shown):
            return
        if self._options.once:
            self._first.set_result(None)
        self._session.say(self._text(shown, info))

    def _selected(self, message: Any) -> Any:
        for field in self._fields:
            try:
                message = getattr(message, field)
            except AttributeError as error:
                raise CommandFailed(f"Invalid field '{'.'.join(self._fields)}': {error}") from None
        return message

    def _text(self, shown: Any, info: MessageInfo) -> str:
        with_info = self._options.include_message_info
        if not hasattr(shown, "get_fields_and_field_types"):
            about = (
                f"---Got new message, message info:---\n{info}\n---Message data:---\n" if with_info else ""
            )
            return f"{about if with_info else ''}{shown}\n---"
        if self._options.csv:
            about = f"{','.join(map(str, info.values()))}," if with_info else ""
            return f"{about}{message_to_csv(shown, **self._shorter)}"
        about = f"{plain_yaml.dump(dict(info))}---\n" if with_info else ""
        text = message_to_yaml(shown, flow_style=self._options.flow_style, **self._shorter)
        return f"{about}{text}---"


ECHO = Verb("echo", "Output messages from a topic", _add_arguments, _echo)
