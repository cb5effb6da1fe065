"""Quality of service: profiles, presets, which go together, and overrides by parameters."""

from typing import Any

import pytest

from sim.interfaces import rcl_interfaces as rcl
from sim.ros.entities.publisher import Publisher
from sim.ros.entities.subscription import Subscription
from sim.ros.node.node import Node
from sim.ros.node.qos_overriding_options import InvalidQosOverridesError, QoSOverridingOptions, overridden
from sim.ros.parameters.parameter import Parameter
from sim.ros.qos.qos import (
    DurabilityPolicy,
    HistoryPolicy,
    InvalidQoSProfileException,
    LivelinessPolicy,
    QoSCompatibility,
    QoSHistoryPolicy,
    QoSPolicyKind,
    QoSPresetProfiles,
    QoSProfile,
    ReliabilityPolicy,
    as_profile,
    mismatches,
    qos_check_compatible,
    qos_policy_name_from_kind,
)
from sim.ros.time.duration import Duration, Infinite
from tests.support.simulation import simulate

SECOND = Duration(seconds=1)


def test_a_profile_needs_a_history_or_a_depth() -> None:
    with pytest.raises(InvalidQoSProfileException) as neither:
        QoSProfile()
    assert neither.value.args == ("Invalid QoSProfile", "History and/or depth settings are required.")
    with pytest.raises(InvalidQoSProfileException) as no_depth:
        QoSProfile(history=HistoryPolicy.KEEP_LAST)
    assert no_depth.value.args[1] == "History set to KEEP_LAST without a depth setting."
    assert QoSProfile(history=HistoryPolicy.KEEP_ALL).depth == 10


def test_a_profile_takes_known_policies_of_the_right_type() -> None:
    with pytest.raises(AssertionError, match="Invalid arguments passed to constructor"):
        QoSProfile(depth=1, foo=1)
    for wrong in ({"reliability": "RELIABLE"}, {"deadline": 1.0}, {"avoid_ros_namespace_conventions": 1}):
        with pytest.raises(AssertionError):
            QoSProfile(depth=1, **wrong)
    with pytest.raises(ValueError, match="99 is not a valid HistoryPolicy"):
        QoSProfile(history=99, depth=1)


def test_policies_are_set_as_numbers_too_and_profiles_compared() -> None:
    profile = QoSProfile(depth=1, reliability=2)
    assert profile.reliability is ReliabilityPolicy.BEST_EFFORT
    assert profile == QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    profile.durability = DurabilityPolicy(1)
    assert profile != QoSProfile(depth=1, reliability=2)


def test_keep_last_with_a_depth_of_zero_warns() -> None:
    with pytest.warns(UserWarning, match="A zero depth with KEEP_LAST doesn't make sense"):
        QoSProfile(depth=0)


def test_a_profile_as_text_names_every_policy() -> None:
    assert str(QoSProfile(depth=3)) == (
        "QoSProfile(history=1, depth=3, reliability=1, durability=2, lifespan=0 nanoseconds, "
        "deadline=0 nanoseconds, liveliness=0, liveliness_lease_duration=0 nanoseconds, "
        "avoid_ros_namespace_conventions=False)"
    )


def test_a_depth_that_is_negative_or_no_number_is_refused() -> None:
    with pytest.raises(ValueError, match="history depth must be greater than or equal to zero"):
        as_profile(-1)
    with pytest.raises(TypeError, match="Expected QoSProfile or int, but received <class 'str'>"):
        as_profile("10")  # type: ignore[arg-type]


def test_policies_have_short_and_old_names() -> None:
    assert ReliabilityPolicy.BEST_EFFORT.short_key == "best_effort"
    assert ReliabilityPolicy.get_from_short_key("RELIABLE") == 1
    assert HistoryPolicy.short_keys() == ["system_default", "keep_last", "keep_all", "unknown"]
    assert QoSHistoryPolicy.RMW_QOS_POLICY_HISTORY_KEEP_ALL.short_key == "keep_all"
    assert qos_policy_name_from_kind(QoSPolicyKind.DURABILITY) == qos_policy_name_from_kind(2) == "DURABILITY"


def test_presets_are_found_by_their_short_names() -> None:
    assert QoSPresetProfiles.get_from_short_key("sensor_data") == QoSProfile(depth=5, reliability=2)
    assert QoSPresetProfiles.ACTION_STATUS_DEFAULT.value == QoSProfile(depth=1, durability=1)
    assert "parameter_events" in QoSPresetProfiles.short_keys()
    assert QoSPresetProfiles["SERVICES_DEFAULT"] is QoSPresetProfiles["DEFAULT"]


def with_deadline(deadline: Duration) -> QoSProfile:
    return QoSProfile(depth=1, deadline=deadline)


MANUAL = QoSProfile(depth=1, liveliness=LivelinessPolicy.MANUAL_BY_TOPIC)


@pytest.mark.parametrize(
    ("offered", "requested", "policies"),
    [
        (QoSProfile(depth=1, reliability=2, durability=2), QoSProfile(depth=1, durability=1), "R D"),
        (with_deadline(Infinite), with_deadline(SECOND), "DEADLINE"),
        (with_deadline(Duration(seconds=2)), with_deadline(SECOND), "DEADLINE"),
        (with_deadline(SECOND), with_deadline(SECOND), ""),
        (with_deadline(SECOND), with_deadline(Duration()), ""),
        (QoSProfile(depth=1), MANUAL, "LIVELINESS"),
        (MANUAL, MANUAL, ""),
        (QoSProfile(depth=1), QoSProfile(depth=1, liveliness_lease_duration=SECOND), "LIVELINESS"),
    ],
)
def test_a_subscription_may_ask_for_no_more_than_is_offered(
    offered: QoSProfile, requested: QoSProfile, policies: str
) -> None:
    expected = {"R D": ["RELIABILITY", "DURABILITY"]}.get(policies, policies.split())
    assert list(mismatches(offered, requested)) == expected
    compatibility, _ = qos_check_compatible(offered, requested)
    assert (compatibility == QoSCompatibility.ERROR) == bool(expected)


def test_the_check_of_two_profiles_gives_its_reason() -> None:
    reliable, best_effort = QoSProfile(depth=1), QoSProfile(depth=1, reliability=2)
    assert qos_check_compatible(reliable, reliable) == (QoSCompatibility.OK, "")
    assert qos_check_compatible(best_effort, reliable) == (
        QoSCompatibility.ERROR,
        "ERROR: Best effort publisher and reliable subscription;",
    )
    compatibility, reason = qos_check_compatible(QoSPresetProfiles.SYSTEM_DEFAULT.value, reliable)
    assert compatibility == QoSCompatibility.WARNING
    assert reason.startswith("WARNING: Publisher's reliability is system default")


def test_parameters_override_the_policies_that_are_named() -> None:
    def program(_: object) -> None:
        overrides: list[Parameter[Any]] = [
            Parameter("qos_overrides./t.publisher.reliability", value="best_effort"),
            Parameter("qos_overrides./t.publisher.depth", value=3),
            Parameter("qos_overrides./t.publisher.durability", value="transient_local"),
        ]
        node = Node("n", parameter_overrides=overrides)
        given = QoSProfile(depth=7)
        found = overridden(Publisher, node, "/t", given, QoSOverridingOptions.with_default_policies())
        assert found == QoSProfile(depth=3, reliability=2)
        assert given == QoSProfile(depth=7)
        assert node.get_parameter("qos_overrides./t.publisher.history").value == "keep_last"

    simulate(program)


def test_a_callback_may_refuse_overrides() -> None:
    def refuse(_: QoSProfile) -> object:
        return rcl.SetParametersResult(successful=False, reason="too shallow")

    def program(_: object) -> None:
        options = QoSOverridingOptions([QoSPolicyKind.DEADLINE], callback=refuse, entity_id="a")
        with pytest.raises(InvalidQosOverridesError, match="are not valid: too shallow"):
            overridden(Subscription, Node("n"), "/t", QoSProfile(depth=1), options)

    simulate(program)


@pytest.mark.parametrize(
    "profile",
    [
        QoSProfile(depth=1, lifespan=Duration(seconds=4)),
        QoSProfile(history=HistoryPolicy.KEEP_ALL, liveliness=LivelinessPolicy.MANUAL_BY_TOPIC),
        QoSPresetProfiles.SENSOR_DATA.value,
    ],
)
def test_a_profile_comes_back_from_the_layers_below(profile: QoSProfile) -> None:
    below = profile.get_c_qos_profile().to_dict()
    assert type(below["history"]) is int
    assert QoSProfile(**below) == profile
