"""``ros2 lifecycle``: the states of managed nodes."""

from sim.ros.lifecycle import Node as ManagedNode
from tests.shell.lines import carry_out, spin
from tests.support.simulation import Simulation


def managed(simulation: Simulation) -> None:
    spin(simulation, ManagedNode("managed"))


def test_nodes_with_a_lifecycle_are_listed() -> None:
    assert carry_out("lifecycle nodes", managed).out == "/managed\n"
    assert carry_out("lifecycle nodes -c", managed).out == "1\n"


def test_the_state_is_told_with_its_number() -> None:
    assert carry_out("lifecycle get /managed", managed).out == "unconfigured [1]\n"
    assert carry_out("lifecycle get", managed).out == "/managed: unconfigured [1]\n"


def test_the_transitions_that_the_state_allows_are_listed() -> None:
    result = carry_out("lifecycle list managed", managed)
    assert result.out.startswith("- configure [1]\n\tStart: unconfigured\n\tGoal: configuring\n- shutdown")
    everything = carry_out("lifecycle list managed -a", managed)
    assert "- activate [3]\n\tStart: inactive\n\tGoal: activating\n" in everything.out


def test_a_transition_is_made_by_name_or_number() -> None:
    for transition in ("configure", "1"):
        result = carry_out(f"lifecycle set /managed {transition}", managed)
        assert (result.out, result.status) == ("Transitioning successful\n", 0)


def test_a_transition_that_the_state_does_not_allow_is_refused_with_those_it_does() -> None:
    result = carry_out("lifecycle set /managed activate", managed)
    assert result.err.startswith("Unknown transition requested, available ones are:\n- configure [1]\n")
    assert result.status == 1


def test_a_node_without_a_lifecycle_is_not_found() -> None:
    result = carry_out("lifecycle get /nobody", managed)
    assert (result.err, result.status) == ("Node not found\n", 1)
