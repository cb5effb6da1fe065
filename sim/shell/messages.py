"""Message and service types by the names that a line gives them, and messages filled from YAML."""

from __future__ import annotations

from typing import Any

from sim.files import plain_yaml
from sim.files.plain_yaml import YamlError
from sim.interfaces import Kind, Message, ServiceType, UnknownInterfaceError
from sim.interfaces.base import ActionType
from sim.interfaces.rosidl_runtime_py import message_to_yaml, set_message_fields
from sim.shell.ground import Ground
from sim.shell.quoting import double_quoted, quoted
from sim.shell.session import CommandFailed

NO_DICTIONARY = "The passed value needs to be a dictionary in YAML format"


def message_class(ground: Ground, name: str) -> type[Message]:
    """Return the class of ``std_msgs/msg/Int32`` or ``std_msgs/Int32``; raise CommandFailed for none."""
    found: type[Message] = _found(ground, name, "msg", "message")
    return found


def service_class(ground: Ground, name: str) -> ServiceType:
    """Return the class of ``std_srvs/srv/SetBool`` or ``std_srvs/SetBool``; raise CommandFailed for none."""
    found: ServiceType = _found(ground, name, "srv", "service")
    return found


def action_class(ground: Ground, name: str) -> ActionType:
    """Return the class of ``example_interfaces/action/Fibonacci``; raise CommandFailed for none."""
    found: ActionType = _found(ground, name, "action", "action")
    return found


def _found(ground: Ground, name: str, kind: Kind, noun: str) -> Any:
    parts = name.split("/")
    if len(parts) == 2:
        parts.insert(1, kind)
    if len(parts) != 3 or parts[1] != kind:
        raise CommandFailed(
            f"The passed {noun} type is invalid: {name!r} is not of the form package/{kind}/Name"
        )
    try:
        return ground.interface(kind, parts[0], parts[2])
    except UnknownInterfaceError as error:
        raise CommandFailed(f"The passed {noun} type is invalid: {error}") from None


def prototype_of(cls: type[Message]) -> str:
    """Return a message with its default values as YAML."""
    return message_to_yaml(cls())


def prototype_word(cls: type[Message]) -> str:
    """Return a message with its default values as YAML on one line, quoted for a shell."""
    text = prototype_of(cls)
    if text.count("\n") == 1:
        return quoted(text)
    return double_quoted(message_to_yaml(cls(), flow_style=True).removesuffix("\n"))


def given_values(text: str) -> object:
    """Return the values in a line's YAML; raise CommandFailed if it is not YAML."""
    try:
        return plain_yaml.load(text)
    except YamlError as error:
        raise CommandFailed(f"{NO_DICTIONARY}: {error}") from None


class Outgoing:
    """A message to send, with the fields that get the time of sending: ``now``, a header's ``auto``.

    Raises:
        CommandFailed: a value does not fit.
    """

    def __init__(self, cls: type[Message], values: object) -> None:
        self.message = cls()
        try:
            self._stamps = set_message_fields(
                self.message,
                values,  # type: ignore[arg-type] # a value that is not a mapping is refused in ros2's words
                expand_header_auto=True,
                expand_time_now=True,
            )
        except (TypeError, AttributeError, ValueError, AssertionError, OverflowError) as error:
            raise CommandFailed(f"Failed to populate field: {error}") from None

    def stamp(self, now: Message) -> None:
        """Set the time, a builtin_interfaces/msg/Time, in these fields."""
        for set_stamp in self._stamps:
            set_stamp(now)
