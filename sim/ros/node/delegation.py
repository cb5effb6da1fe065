"""Delegation: makes methods and properties of a node's parts available on the node, as in rclpy."""

from collections.abc import Callable
from functools import wraps
from typing import Any, Concatenate, Generic, ParamSpec, TypeVar

PartT = TypeVar("PartT")
ParametersT = ParamSpec("ParametersT")
ResultT = TypeVar("ResultT")


class Delegated(Generic[PartT]):
    """Makes methods of Node from those of the part in ``attribute``."""

    def __init__(self, attribute: str) -> None:
        self._attribute = attribute

    def __call__(
        self, method: Callable[Concatenate[PartT, ParametersT], ResultT]
    ) -> Callable[Concatenate[Any, ParametersT], ResultT]:
        """Delegate a method. Errors of a wrong call name ``Node``, the only class that programs know.

        On the stack it has the method's name, too, by which it is known what a program has called.
        """
        attribute = self._attribute

        def delegated(node: Any, /, *args: ParametersT.args, **kwargs: ParametersT.kwargs) -> ResultT:
            return method(getattr(node, attribute), *args, **kwargs)

        delegated.__code__ = delegated.__code__.replace(co_name=method.__name__)
        wrapped = wraps(method)(delegated)
        method.__qualname__ = wrapped.__qualname__ = f"Node.{method.__name__}"
        return wrapped

    def view(self, of: Any) -> property:
        """Delegate a read-only property."""
        attribute, read = self._attribute, of.fget
        return property(lambda node: read(getattr(node, attribute)), doc=of.__doc__)
