"""Names: which are refused with which words and where, and what short ones become."""

from collections.abc import Callable
from typing import Any

import pytest

from sim.interfaces import message
from sim.ros.exceptions import (
    InvalidNamespaceException,
    InvalidNodeNameException,
    InvalidServiceNameException,
    InvalidTopicNameException,
    NameValidationException,
)
from sim.ros.naming.expand_topic_name import expand_topic_name
from sim.ros.naming.validation import (
    validate_full_topic_name,
    validate_namespace,
    validate_node_name,
    validate_topic_name,
)
from sim.ros.node.node import Node
from sim.ros.rclpy._naming.topic_or_service_is_hidden import topic_or_service_is_hidden
from tests.support.simulation import simulate


def problem(error: NameValidationException) -> tuple[str, int]:
    return error.error_msg, error.invalid_index


@pytest.mark.parametrize("name", ["chatter", "/chatter", "~/chatter", "~", "{node}/chatter", "a/{ns}/_b1"])
def test_a_topic_may_be_written_in_many_ways(name: str) -> None:
    assert validate_topic_name(name) is True
    assert validate_topic_name(name, is_service=True) is True


@pytest.mark.parametrize(
    ("name", "text", "index"),
    [
        ("", "must not be empty string", 0),
        ("/", "must not end with a forward slash", 0),
        ("a/", "must not end with a forward slash", 1),
        ("/a?b", "must not contain characters other than alphanumerics, '_', '~', '{', or '}'", 2),
        ("a/5b", "token must not start with a number", 2),
        ("5b", "token must not start with a number", 0),
        ("a{b", "must not have unmatched (unbalanced) curly braces '{}'", 1),
        ("a}b", "must not have unmatched (unbalanced) curly braces '{}'", 1),
        ("a/~", "must not have tilde '~' unless it is the first character", 2),
        ("~a", "must not have a tilde '~' that is not followed by a forward slash '/'", 1),
        ("{a?}", "", 2),
        ("{1a}", "", 1),
    ],
)
def test_what_is_wrong_with_a_topic_and_where(name: str, text: str, index: int) -> None:
    expected = f"topic name {text}" if text else None
    with pytest.raises(InvalidTopicNameException) as topic:
        validate_topic_name(name)
    with pytest.raises(InvalidServiceNameException) as service:
        validate_topic_name(name, is_service=True)
    assert problem(topic.value) == problem(service.value)
    assert topic.value.invalid_index == index
    assert expected in {None, topic.value.error_msg}
    assert str(topic.value).startswith("Invalid topic name: ")
    assert str(service.value).startswith("Invalid service name: ")


def test_the_caret_stands_under_the_place() -> None:
    with pytest.raises(InvalidTopicNameException) as found:
        validate_topic_name("/a?b")
    assert str(found.value).splitlines()[1:] == ["  '/a?b'", "     ^"]


@pytest.mark.parametrize(
    ("name", "text", "index"),
    [
        ("", "topic name must not be empty", 0),
        ("a", "topic name must be absolute, it must lead with a '/'", 0),
        ("/a/", "topic name must not end with a '/'", 2),
        ("/a~", "topic name must not contain characters other than alphanumerics, '_', or '/'", 2),
        ("/a//b", "topic name must not contain repeated '/'", 3),
        ("/a/5", "topic name must not have a token that starts with a number", 3),
        ("/" + "a" * 247, "topic length should not exceed '247'", 246),
    ],
)
def test_what_is_wrong_with_a_full_topic_name(name: str, text: str, index: int) -> None:
    with pytest.raises(InvalidTopicNameException) as found:
        validate_full_topic_name(name)
    assert problem(found.value) == (text, index)
    with pytest.raises(InvalidServiceNameException):
        validate_full_topic_name(name, is_service=True)


def test_a_full_topic_name_that_keeps_the_rules_is_taken() -> None:
    assert validate_full_topic_name("/a/b_1") is True


@pytest.mark.parametrize(
    ("name", "text", "index"),
    [
        ("", "namespace must not be empty", 0),
        ("a", "namespace must be absolute, it must lead with a '/'", 0),
        ("/a/", "namespace must not end with a '/', unless only a '/'", 2),
        ("/a?", "namespace must not contain characters other than alphanumerics, '_', or '/'", 2),
        ("//a", "namespace must not contain repeated '/'", 1),
        ("/1a", "namespace must not have a token that starts with a number", 1),
        ("/" + "a" * 245, "namespace should not exceed '245'", 244),
    ],
)
def test_what_is_wrong_with_a_namespace(name: str, text: str, index: int) -> None:
    with pytest.raises(InvalidNamespaceException) as found:
        validate_namespace(name)
    assert problem(found.value) == (text, index)


@pytest.mark.parametrize(
    ("name", "text", "index"),
    [
        ("", "node name must not be empty", 0),
        ("a/b", "node name must not contain characters other than alphanumerics or '_'", 1),
        ("1a", "node name must not start with a number", 0),
        ("a" * 256, "node name length should not exceed '255'", 254),
    ],
)
def test_what_is_wrong_with_the_name_of_a_node(name: str, text: str, index: int) -> None:
    with pytest.raises(InvalidNodeNameException) as found:
        validate_node_name(name)
    assert problem(found.value) == (text, index)


def test_good_namespaces_and_node_names_are_taken() -> None:
    assert validate_namespace("/") is validate_namespace("/a/b") is validate_node_name("a_1") is True


@pytest.mark.parametrize(
    ("name", "namespace", "full"),
    [
        ("chatter", "/ns", "/ns/chatter"),
        ("chatter", "/", "/chatter"),
        ("~/chatter", "/ns", "/ns/n/chatter"),
        ("~", "/", "/n"),
        ("{node}/x", "/ns", "/ns/n/x"),
        ("{ns}/x", "/ns", "/ns/x"),
        ("/x", "/ns", "/x"),
    ],
)
def test_a_short_name_becomes_full(name: str, namespace: str, full: str) -> None:
    assert expand_topic_name(name, "n", namespace) == full


@pytest.mark.parametrize(
    ("arguments", "what"),
    [
        (("a?", "n", "/"), "topic name"),
        (("a", "n?", "/"), "node name"),
        (("a", "n", ""), "namespace"),
        (("a", "n", "ns"), "namespace"),
        (("{what}/a", "n", "/"), "unknown substitution '{what}'"),
    ],
)
def test_only_good_names_become_full(arguments: tuple[str, str, str], what: str) -> None:
    with pytest.raises(ValueError, match=what):
        expand_topic_name(*arguments)


def test_a_node_refuses_a_bad_name_as_it_was_written() -> None:
    def program(_: object) -> None:
        node = Node("n", namespace="/ns")
        with pytest.raises(InvalidTopicNameException) as found:
            node.create_publisher(message("std_msgs", "Int32"), "a?b", 1)
        assert (found.value.name, found.value.invalid_index) == ("a?b", 1)
        with pytest.raises(InvalidTopicNameException):
            node.create_publisher(message("std_msgs", "Int32"), "a//b", 1)

    simulate(program)


def test_a_node_refuses_an_unknown_substitution() -> None:
    def program(_: object) -> None:
        node = Node("n")
        with pytest.raises(ValueError, match=r"^unknown substitution '\{what\}'$"):
            node.create_publisher(message("std_msgs", "Int32"), "a/{what}", 1)
        with pytest.raises(ValueError, match="unknown substitution"):
            node.resolve_service_name("{what}/a")

    simulate(program)


@pytest.mark.parametrize(
    "validate", [validate_node_name, validate_namespace, validate_topic_name, validate_full_topic_name]
)
def test_what_is_no_text_is_no_name(validate: Callable[[Any], object]) -> None:
    for wrong in (None, 1, ["n"]):
        with pytest.raises(TypeError, match="a name must be a str"):
            validate(wrong)


@pytest.mark.parametrize(
    ("name", "hidden"),
    [
        ("/chatter", False),
        ("chatter", False),
        ("/a_b/c_", False),
        ("/", False),
        ("/_chatter", True),
        ("_chatter", True),
        ("/more/_complex/chatter", True),
    ],
)
def test_a_part_that_begins_with_an_underscore_hides_a_name(name: str, hidden: bool) -> None:
    assert topic_or_service_is_hidden(name) is hidden
