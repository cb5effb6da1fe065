"""What a node is called, and what the names it uses for topics and services become."""

from __future__ import annotations

from sim.ros.naming.names import expand_service, expand_topic
from sim.ros.naming.remapping import Remapping
from sim.ros.naming.validate_namespace import validate_namespace
from sim.ros.naming.validate_node_name import validate_node_name


class NodeNames:
    """The names of one node, remapped.

    Raises:
        InvalidNodeNameException, InvalidNamespaceException: a name breaks the rules.
    """

    def __init__(self, name: str, namespace: str, remapping: Remapping) -> None:
        validate_node_name(name)
        space = namespace if namespace.startswith("/") else f"/{namespace}"
        validate_namespace(space)
        self.name = remapping.node_name(name)
        # A rule for one node's namespace knows the node by the name it has got.
        self.namespace = remapping.namespace(space, self.name)
        self._remapping = remapping

    @property
    def full_name(self) -> str:
        """Namespace and name, such as ``/arm/sub_node``."""
        return f"{self.namespace.rstrip('/')}/{self.name}"

    @property
    def logger_name(self) -> str:
        """The name of the node's logger, such as ``arm.sub_node``."""
        return self.full_name.strip("/").replace("/", ".")

    def expanded_topic(self, topic: str) -> str:
        """The full name of a topic, before remapping.

        Raises:
            InvalidTopicNameException: the name breaks the rules.
        """
        return expand_topic(topic, self.name, self.namespace)

    def topic(self, topic: str) -> str:
        """The full name of a topic; raises as ``expanded_topic``."""
        return self._remapping.topic(self.expanded_topic(topic), self.name, self.namespace)

    def expanded_service(self, service: str) -> str:
        """The full name of a service, before remapping.

        Raises:
            InvalidServiceNameException: the name breaks the rules.
        """
        return expand_service(service, self.name, self.namespace)

    def service(self, service: str) -> str:
        """The full name of a service; raises as ``expanded_service``."""
        return self._remapping.service(self.expanded_service(service), self.name, self.namespace)
