"""Methods and properties of a node that belong to one of its parts: rclpy has them all on one class."""

from __future__ import annotations

from collections.abc import Callable
from functools import wraps
from typing import Any, Concatenate, Generic, ParamSpec, TypeVar

PartT = TypeVar("PartT")
ParametersT = ParamSpec("ParametersT")
ResultT = TypeVar("ResultT")


class Delegated(Generic[PartT]):
    """Makes methods of Node out of those of the part that a node has as ``attribute``."""

    def __init__(self, attribute: str) -> None:
        self._attribute = attribute

    def __call__(
        self, method: Callable[Concatenate[PartT, ParametersT], ResultT]
    ) -> Callable[Concatenate[Any, ParametersT], ResultT]:
        """Have a node's part do it; a wrong call is told as one of Node's: programs know no other class."""
        attribute = self._attribute

        @wraps(method)
        def call(node: Any, /, *args: ParametersT.args, **kwargs: ParametersT.kwargs) -> ResultT:
            return method(getattr(node, attribute), *args, **kwargs)

        method.__qualname__ = call.__qualname__ = f"Node.{method.__name__}"
        return call

    def view(self, of: Any) -> property:
        """Show a property of the part as one of the node."""
        attribute, read = self._attribute, of.fget
        return property(lambda node: read(getattr(node, attribute)), doc=of.__doc__)
