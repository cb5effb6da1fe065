"""The options for quality of service, and the profile that matches a topic's publishers.

Source: ros2topic's api module.
"""

from __future__ import annotations

from argparse import Namespace
from collections.abc import Sequence
from copy import copy

from sim.ros.entities.topic_endpoint_info import TopicEndpointInfo
from sim.ros.qos.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    LivelinessPolicy,
    QoSPresetProfiles,
    QoSProfile,
    ReliabilityPolicy,
)
from sim.ros.time.duration import Duration
from sim.shell.parser import LineParser, nonnegative_int
from sim.shell.session import ShellSession

_POLICIES = {
    "history": (HistoryPolicy, "History of samples"),
    "reliability": (ReliabilityPolicy, "Quality of service reliability"),
    "durability": (DurabilityPolicy, "Quality of service durability"),
    "liveliness": (LivelinessPolicy, "Quality of service liveliness"),
}


def add_qos_options(parser: LineParser, purpose: str, default: str) -> None:
    """Add ``--qos-profile`` and its kin; ``default`` is the short name of a profile."""
    parser.add_argument(
        "--qos-profile",
        choices=QoSPresetProfiles.short_keys(),
        metavar="PROFILE",
        help=f"Quality of service preset profile to {purpose} with (default: {default})",
    )
    parser.add_argument(
        "--qos-depth", metavar="N", type=nonnegative_int, help=f"Queue size setting to {purpose} with"
    )
    for name, (policy, text) in _POLICIES.items():
        parser.add_argument(
            f"--qos-{name}",
            choices=policy.short_keys(),
            metavar=name.upper(),
            help=f"{text} setting to {purpose} with",
        )
    parser.add_argument(
        "--qos-liveliness-lease-duration-seconds",
        type=float,
        metavar="SECONDS",
        help=f"Quality of service liveliness lease duration setting to {purpose} with",
    )
    parser.set_defaults(default_qos_profile=default)


def qos_is_given(arguments: Namespace) -> bool:
    """Return whether a line has any option for quality of service."""
    given = (arguments.qos_profile, arguments.qos_depth, arguments.qos_liveliness_lease_duration_seconds)
    return any(each is not None for each in (*given, *_policies(arguments).values()))


def chosen_qos(arguments: Namespace) -> QoSProfile:
    """Return the profile of the options."""
    name = arguments.qos_profile or arguments.default_qos_profile
    profile = copy(QoSPresetProfiles.get_from_short_key(name))
    if arguments.qos_depth is not None:
        profile.depth = arguments.qos_depth
    for policy, short in _policies(arguments).items():
        if short is not None:
            setattr(profile, policy, _POLICIES[policy][0].get_from_short_key(short))
    if arguments.qos_liveliness_lease_duration_seconds is not None:
        profile.liveliness_lease_duration = Duration(seconds=arguments.qos_liveliness_lease_duration_seconds)
    return profile


def matching_qos(session: ShellSession, topic: str, arguments: Namespace) -> QoSProfile:
    """Return the profile of the options; without any, one that matches all of a topic's publishers."""
    profile = chosen_qos(arguments)
    publishers = session.node.get_publishers_info_by_topic(topic)
    if qos_is_given(arguments) or not publishers:
        return profile
    reliable = _share(publishers, "reliability", ReliabilityPolicy.RELIABLE)
    lasting = _share(publishers, "durability", DurabilityPolicy.TRANSIENT_LOCAL)
    for share, offered, fallback in (
        (reliable, "QoSReliabilityPolicy.RELIABLE", "QoSReliabilityPolicy.BEST_EFFORT"),
        (lasting, "QoSDurabilityPolicy.TRANSIENT_LOCAL", "QoSDurabilityPolicy.VOLATILE"),
    ):
        if 0 < share < 1:
            session.say(
                f"Some, but not all, publishers are offering {offered}. Falling back to {fallback} "
                "as it will connect to all publishers"
            )
    profile.reliability = ReliabilityPolicy.RELIABLE if reliable == 1 else ReliabilityPolicy.BEST_EFFORT
    profile.durability = DurabilityPolicy.TRANSIENT_LOCAL if lasting == 1 else DurabilityPolicy.VOLATILE
    return profile


def _policies(arguments: Namespace) -> dict[str, str | None]:
    return {name: getattr(arguments, f"qos_{name}") for name in _POLICIES}


def _share(publishers: Sequence[TopicEndpointInfo], policy: str, wanted: object) -> float:
    return [getattr(each.qos_profile, policy) for each in publishers].count(wanted) / len(publishers)
