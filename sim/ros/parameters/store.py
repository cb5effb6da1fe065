"""A node's parameters: declares, sets, describes and removes them, and calls the callbacks."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any, TypeAlias

from sim.interfaces import rcl_interfaces
from sim.ros.exceptions import (
    InvalidParameterTypeException,
    InvalidParameterValueException,
    ParameterAlreadyDeclaredException,
    ParameterImmutableException,
    ParameterNotDeclaredException,
    ParameterUninitializedException,
)
from sim.ros.naming.validation import validate_parameter_name
from sim.ros.parameters.checks import has_wrong_type, objection
from sim.ros.parameters.declaration import read_declaration
from sim.ros.parameters.listing import listed
from sim.ros.parameters.on_set import AnyParameter, OnSetCallback, OnSetCallbacks, result_for
from sim.ros.parameters.parameter import PARAMETER_SEPARATOR_STRING, Parameter, parameter_value_to_python

PreSetCallback: TypeAlias = Callable[[list[AnyParameter]], list[AnyParameter]]
PostSetCallback: TypeAlias = Callable[[list[AnyParameter]], None]

_NOT_SET = Parameter.Type.NOT_SET

_NOTHING_LEFT = (
    "parameter list cannot be empty, this might be due to pre_set_parameters_callback modifying the original "
    "parameters list."
)


@dataclass(slots=True)
class ParameterChange:
    """The changes of one setting of parameters."""

    new: list[AnyParameter] = field(default_factory=list)
    changed: list[AnyParameter] = field(default_factory=list)
    deleted: list[AnyParameter] = field(default_factory=list)


class ParameterStore:
    """The parameters of a node by name. Callbacks run on the thread that sets parameters, the newest first.

    ``publish`` is called with every change, ``refused`` with the names that are refused together, and the
    reason.
    """

    def __init__(
        self,
        overrides: Iterable[AnyParameter],
        publish: Callable[[ParameterChange], None],
        on_set: OnSetCallbacks,
        refused: Callable[[Sequence[str], str], None],
        *,
        allow_undeclared: bool,
    ) -> None:
        self._publish = publish
        self._refused = refused
        self._on_set = on_set
        self._parameters: dict[str, AnyParameter] = {}
        self._descriptors: dict[str, Any] = {}
        self._parameter_overrides = {each.name: each for each in overrides}
        self._allow_undeclared_parameters = allow_undeclared
        self._pre_set_parameters_callbacks: list[PreSetCallback] = []
        self._post_set_parameters_callbacks: list[PostSetCallback] = []

    # Declaring

    def declare_parameter(
        self, name: str, value: Any = None, descriptor: Any = None, ignore_override: bool = False
    ) -> AnyParameter:
        """Declare a parameter with a value, or with a ``Parameter.Type`` and no value yet.

        An override from the command line, a file or the node's constructor replaces ``value``.

        Raises:
            ParameterAlreadyDeclaredException, InvalidParameterException, InvalidParameterTypeException:
                the parameter exists, has no name, or is overridden by a value of another type.
            InvalidParameterValueException: the descriptor or a callback refuses the value.
        """
        declared: tuple[Any, ...] = (name,)
        if value is not None or descriptor is not None:
            declared = (
                name,
                value,
                rcl_interfaces.ParameterDescriptor() if descriptor is None else descriptor,
            )
        return self.declare_parameters("", [declared], ignore_override)[0]

    def declare_parameters(
        self, namespace: str, parameters: Sequence[tuple[Any, ...]], ignore_override: bool = False
    ) -> list[AnyParameter]:
        """Declare parameters given as (name,), (name, value or type) or (name, value or type, descriptor).

        Each name gets the prefix ``namespace`` and a dot, unless the namespace is empty.

        Raises:
            TypeError, ValueError: an entry has another form, or contradicts itself.
            ParameterAlreadyDeclaredException, InvalidParameterException, InvalidParameterTypeException,
            InvalidParameterValueException: as ``declare_parameter``; earlier parameters stay declared.
        """
        wanted: list[tuple[AnyParameter, Any]] = []
        for index, entry in enumerate(parameters):
            name, value, descriptor = read_declaration(index, entry)
            full_name = f"{namespace}{PARAMETER_SEPARATOR_STRING}{name}" if namespace else name
            if not ignore_override and full_name in self._parameter_overrides:
                value = self._parameter_overrides[full_name].value
            validate_parameter_name(full_name)
            wanted.append((Parameter(full_name, value=value), descriptor))
        names = [parameter.name for parameter, _ in wanted]
        if known := [name for name in names if name in self._parameters]:
            raise ParameterAlreadyDeclaredException(known)
        for parameter, descriptor in wanted:
            self._declare(parameter, descriptor)
        return [self._parameters[name] for name in names]

    def declare_overrides(self) -> None:
        """Declare all parameters that have overrides."""
        declared = [
            (each.name, each.value, rcl_interfaces.ParameterDescriptor())
            for each in self._parameter_overrides.values()
        ]
        self.declare_parameters("", declared, ignore_override=True)

    def _declare(self, parameter: AnyParameter, descriptor: Any) -> None:
        descriptor.name = parameter.name
        reason = objection(parameter, descriptor)
        if has_wrong_type(parameter, descriptor):
            raise InvalidParameterTypeException(parameter, Parameter.Type(descriptor.type).name)
        if not reason:
            result = self._on_set.ask([parameter])
            if result.successful:
                self._descriptors[parameter.name] = descriptor
                change = ParameterChange()
                self._store(parameter, change)
                self._finish_setting([parameter], change)
                return
            reason = result.reason
        raise InvalidParameterValueException(parameter.name, parameter.value, reason)

    def undeclare_parameter(self, name: str) -> None:
        """Remove a parameter.

        Raises:
            ParameterNotDeclaredException, ParameterImmutableException: it is not declared, or is read-only.
        """
        if not self.has_parameter(name):
            raise ParameterNotDeclaredException(name)
        if self._descriptors[name].read_only:
            raise ParameterImmutableException(name)
        del self._parameters[name]
        del self._descriptors[name]

    # Reading

    def has_parameter(self, name: str) -> bool:
        """Whether a parameter is declared."""
        return name in self._parameters

    def get_parameter(self, name: str) -> AnyParameter:
        """A parameter.

        Raises:
            ParameterNotDeclaredException: it is not declared, and undeclared ones are not allowed.
            ParameterUninitializedException: it has a type but no value yet.
        """
        parameter = self._parameters.get(name)
        if parameter is None:
            self._require_undeclared_allowed(name)
            return Parameter(name, _NOT_SET)
        if parameter.type_ is _NOT_SET and not self._descriptors[name].dynamic_typing:
            raise ParameterUninitializedException(name)
        return parameter

    def get_parameters(self, names: list[str]) -> list[AnyParameter]:
        """The parameters of these names, in the same order; raises as ``get_parameter``."""
        _require_names(names)
        return [self.get_parameter(name) for name in names]

    def get_parameter_or(self, name: str, alternative_value: AnyParameter | None = None) -> AnyParameter:
        """A parameter; without a value, the alternative, which by default is an unset parameter."""
        parameter = self._parameters.get(name)
        if parameter is not None and parameter.type_ is not _NOT_SET:
            return parameter
        return Parameter(name, _NOT_SET) if alternative_value is None else alternative_value

    def get_parameters_by_prefix(self, prefix: str) -> dict[str, AnyParameter]:
        """The parameters called ``prefix.…`` by the rest of their names; the empty prefix means all."""
        start = prefix + PARAMETER_SEPARATOR_STRING if prefix else ""
        return {
            name.removeprefix(start): parameter
            for name, parameter in tuple(self._parameters.items())
            if name.startswith(start)
        }

    def get_parameter_type(self, name: str) -> Parameter.Type:
        """The type of a parameter.

        Raises:
            ParameterNotDeclaredException: it is not declared, and undeclared ones are not allowed.
        """
        if name in self._parameters:
            return self._parameters[name].type_
        self._require_undeclared_allowed(name)
        return _NOT_SET

    def get_parameter_types(self, names: list[str]) -> list[Parameter.Type]:
        """The types of parameters; raises as ``get_parameter_type``."""
        _require_names(names)
        return [self.get_parameter_type(name) for name in names]

    def list_parameters(self, prefixes: list[str], depth: int) -> Any:
        """The names with the prefixes (none: all), at most ``depth`` levels deep (0: any), as a message.

        Raises:
            TypeError, ValueError: the prefixes are not a list of str, or the depth is not an int from 0 on.
        """
        names, nested = listed(self._parameters, prefixes, depth)
        return rcl_interfaces.ListParametersResult(names=names, prefixes=nested)

    # Setting

    def set_parameters(self, parameter_list: list[AnyParameter]) -> list[Any]:
        """Set parameters one by one, and return their results. ``NOT_SET`` removes a dynamically typed one.

        Raises:
            ParameterNotDeclaredException: one is not declared, and undeclared ones are not allowed; then
                no parameter is set.
            TypeError: one is not a ``Parameter``.
        """
        if not self._pre_set_parameters_callbacks:
            self._require_declared(parameter_list)
        return [self.set_parameters_atomically([parameter]) for parameter in parameter_list]

    def set_parameters_atomically(self, parameter_list: list[AnyParameter]) -> Any:
        """Set all of the parameters or none, and return one result. Raises as ``set_parameters``."""
        chosen = list(parameter_list)
        if self._pre_set_parameters_callbacks:
            asked = tuple(self._pre_set_parameters_callbacks)
            chosen = [parameter for callback in asked for parameter in callback(list(parameter_list))]
            if not chosen:
                return result_for(_NOTHING_LEFT)
        self._require_declared(chosen)
        reason = self._objection_to(chosen)
        result = result_for(reason) if reason else self._on_set.ask(chosen)
        if not result.successful:
            self._refused([each.name for each in chosen], result.reason)
            return result
        change = ParameterChange()
        for parameter in chosen:
            if parameter.type_ is _NOT_SET:
                self._drop(parameter, change)
            else:
                self._store(parameter, change)
        self._finish_setting(chosen, change)
        return result

    def _objection_to(self, parameters: list[AnyParameter]) -> str:
        for parameter in parameters:
            descriptor = self._descriptors.get(parameter.name)
            if descriptor is None:
                continue
            if descriptor.read_only:
                return f"Trying to set a read-only parameter: {parameter.name}."
            if parameter.type_ is _NOT_SET and not descriptor.dynamic_typing:
                return "Static parameter cannot be undeclared"
            if reason := objection(parameter, descriptor):
                return reason
        return ""

    def _store(self, parameter: AnyParameter, change: ParameterChange) -> None:
        known = self.get_parameter_or(parameter.name).type_ is not _NOT_SET
        (change.changed if known else change.new).append(parameter)
        if parameter.name not in self._descriptors:
            self._descriptors[parameter.name] = rcl_interfaces.ParameterDescriptor(dynamic_typing=True)
        self._parameters[parameter.name] = parameter

    def _drop(self, parameter: AnyParameter, change: ParameterChange) -> None:
        if self.get_parameter_or(parameter.name).type_ is not _NOT_SET:
            change.deleted.append(parameter)
        self._parameters.pop(parameter.name, None)
        self._descriptors.pop(parameter.name, None)

    def _finish_setting(self, parameters: list[AnyParameter], change: ParameterChange) -> None:
        self._publish(change)
        for callback in tuple(self._post_set_parameters_callbacks):
            callback(parameters)

    # Callbacks

    def add_pre_set_parameters_callback(self, callback: PreSetCallback) -> None:
        """Let ``callback`` replace the parameters to set, before any check."""
        self._pre_set_parameters_callbacks.insert(0, callback)

    def add_on_set_parameters_callback(self, callback: OnSetCallback) -> None:
        """Let ``callback`` allow or refuse the parameters to set, by a SetParametersResult.

        Raises:
            TypeError: the callback is not callable.
        """
        if not callable(callback):
            raise TypeError("Callback must be callable, got {}", type(callback))
        self._on_set.callbacks.insert(0, callback)

    def add_post_set_parameters_callback(self, callback: PostSetCallback) -> None:
        """Call ``callback`` with the parameters that were set."""
        self._post_set_parameters_callbacks.insert(0, callback)

    def remove_pre_set_parameters_callback(self, callback: PreSetCallback) -> None:
        """Remove ``callback``; ValueError if it was not added."""
        self._pre_set_parameters_callbacks.remove(callback)

    def remove_on_set_parameters_callback(self, callback: OnSetCallback) -> None:
        """Remove ``callback``; ValueError if it was not added."""
        self._on_set.callbacks.remove(callback)

    def remove_post_set_parameters_callback(self, callback: PostSetCallback) -> None:
        """Remove ``callback``; ValueError if it was not added."""
        self._post_set_parameters_callbacks.remove(callback)

    # Describing

    def describe_parameter(self, name: str) -> Any:
        """The descriptor of a parameter.

        Raises:
            ParameterNotDeclaredException: it is not declared, and undeclared ones are not allowed.
        """
        if name in self._descriptors:
            return self._descriptors[name]
        self._require_undeclared_allowed(name)
        return rcl_interfaces.ParameterDescriptor()

    def describe_parameters(self, names: list[str]) -> list[Any]:
        """The descriptors of parameters; raises as ``describe_parameter``."""
        return [self.describe_parameter(name) for name in names]

    def set_descriptor(self, name: str, descriptor: Any, alternative_value: Any = None) -> Any:
        """Replace a parameter's descriptor, and return its value, a ParameterValue.

        If the new descriptor does not allow the value, the alternative, also a ParameterValue, replaces
        it. A descriptor without a type keeps the parameter's type.

        Raises:
            ParameterNotDeclaredException, ParameterImmutableException: it is not declared, or is read-only.
            InvalidParameterValueException: the descriptor allows neither value.
        """
        current = self.get_parameter(name)
        if not self.has_parameter(name):
            return current.get_parameter_value()
        if self.describe_parameter(name).read_only:
            raise ParameterImmutableException(name)
        descriptor.name = name
        if descriptor.type == _NOT_SET:
            descriptor.type = current.type_.value
        if reason := objection(current, descriptor):
            if alternative_value is not None:
                current = Parameter(name, value=parameter_value_to_python(alternative_value))
                reason = objection(current, descriptor)
            if reason:
                raise InvalidParameterValueException(name, current.value, reason)
        self._descriptors[name] = descriptor
        self._parameters[name] = current
        return current.get_parameter_value()

    # Rules

    def _require_undeclared_allowed(self, name: str) -> None:
        if not self._allow_undeclared_parameters:
            raise ParameterNotDeclaredException(name)

    def _require_declared(self, parameters: Iterable[AnyParameter]) -> None:
        if not all(isinstance(each, Parameter) for each in parameters):
            raise TypeError(f"parameter must be instance of type '{Parameter!r}'")
        undeclared = [each.name for each in parameters if each.name not in self._parameters]
        if undeclared and not self._allow_undeclared_parameters:
            raise ParameterNotDeclaredException(undeclared)


def _require_names(names: Iterable[object]) -> None:
    if not all(isinstance(name, str) for name in names):
        raise TypeError("All names must be instances of type str")
