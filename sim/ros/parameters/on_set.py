"""The callbacks that are asked before parameters are set, and what they do wrong."""

import threading
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, TypeAlias

from sim.interfaces import rcl_interfaces
from sim.ros.parameters.parameter import Parameter

AnyParameter: TypeAlias = Parameter[Any]
OnSetCallback: TypeAlias = Callable[[list[AnyParameter]], Any]

_INVALID = "Callback returned an invalid type"


class _Thread(threading.local):
    """The names of the parameters that a thread is setting, during its on-set callbacks."""

    names: frozenset[str] = frozenset()


class OnSetCallbacks:
    """The on-set callbacks of a node, the newest first.

    ``overruled`` is called once for each parameter that one of them sets while it is being set, which has no
    effect; ``unanswered`` with each callback that returns no SetParametersResult. Asking is thread-safe.
    """

    def __init__(self, overruled: Callable[[str], None], unanswered: Callable[[OnSetCallback], None]) -> None:
        self.callbacks: list[OnSetCallback] = []
        self._overruled, self._unanswered = overruled, unanswered
        self._thread = _Thread()
        self._reported: set[str] = set()

    def ask(self, parameters: list[AnyParameter]) -> Any:
        """Return the first refusal, or a result that allows the parameters.

        Source: rclpy's ``Node._set_parameters_atomically_common``, for what returns no such result, too.
        """
        with self._setting(parameters):
            for callback in tuple(self.callbacks):
                result = callback(parameters)
                if not isinstance(result, rcl_interfaces.SetParametersResult):
                    warnings.warn(f"{_INVALID}, it should return SetParameterResult.", stacklevel=1)
                    self._unanswered(callback)
                    result = result_for(_INVALID)
                if not result.successful:
                    return result
        return result_for("")

    @contextmanager
    def _setting(self, parameters: list[AnyParameter]) -> Iterator[None]:
        outer, inner = self._thread.names, frozenset(each.name for each in parameters)
        for name in sorted((inner & outer) - self._reported):
            self._reported.add(name)
            self._overruled(name)
        self._thread.names = outer | inner
        try:
            yield
        finally:
            self._thread.names = outer


def result_for(reason: str) -> Any:
    """Return a result that refuses for a reason; one that allows for none."""
    return rcl_interfaces.SetParametersResult(successful=not reason, reason=reason)
