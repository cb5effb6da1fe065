"""The name of a node, and the full names of the topics and services that it uses."""

from sim.ros.naming.names import expand
from sim.ros.naming.remapping import Remapping
from sim.ros.naming.validation import validate_namespace, validate_node_name


class NodeNames:
    """The names of one node, remapped.

    Raises:
        InvalidNodeNameException, InvalidNamespaceException: a name breaks the rules.
    """

    def __init__(self, name: str, namespace: str, remapping: Remapping) -> None:
        validate_node_name(name)
        absolute = namespace if namespace.startswith("/") else f"/{namespace}"
        validate_namespace(absolute)
        self.name = remapping.node_name(name)
        # A rule for the namespace of one node names the node by its remapped name.
        self.namespace = remapping.namespace(absolute, self.name)
        self._remapping = remapping

    @property
    def full_name(self) -> str:
        """Namespace and name, such as ``/arm/sub_node``."""
        return f"{self.namespace.rstrip('/')}/{self.name}"

    @property
    def logger_name(self) -> str:
        """The name of the node's logger, such as ``arm.sub_node``."""
        return self.full_name.strip("/").replace("/", ".")

    def resolve(self, name: str, *, is_service: bool, only_expand: bool) -> str:
        """The full name of a topic or service; remapped, unless ``only_expand``.

        Raises:
            InvalidTopicNameException, InvalidServiceNameException: the name breaks the rules.
            UnknownSubstitutionError: the name has an unknown substitution.
        """
        full = expand(name, self.name, self.namespace, is_service=is_service)
        if only_expand:
            return full
        return self._remapping.renamed(full, self.name, self.namespace, is_service=is_service)
