"""Exceptions that are worded alike in every program: the reason, and what to do."""

import re


def known_reason(error: str) -> tuple[str, str] | None:
    """Return the reason and the cure of an exception as it is printed; None if it is not known."""
    for pattern, why, cure in reversed(_KNOWN):
        if known := pattern.fullmatch(error):
            return known.expand(why), known.expand(cure)
    return None


NO_FLOAT = re.compile(r"AssertionError: The '(\w+)' field must be of type 'float'")
"""The error of a whole number in a field of type float; the group is the field."""

NO_RESULT = re.compile(r"AssertionError: The 'result' field must be a sub message of type '(\w+)_Result'")
"""The error of an action's execute callback that returned no result; the group is the action."""

SPUN_TWICE = "ValueError: generator already executing"
"""The error of an executor that a second thread spins, in rclpy before Jazzy 7.1.9."""

_NODE_PROPERTIES = (
    "clients|context|default_callback_group|guards|publishers|services|subscriptions|timers|waitables"
)
_OF_NODES = r"every node of rclpy has a property \1, and nothing can be assigned to it"
_OTHER_NAME = r"give the attribute another name, such as my_\1"
_OTHER_TYPE = r"InvalidParameterTypeException: Trying to set parameter '([^']+)' to '(.*)'"
_OVERRIDDEN = r"the node declares \1 with a value of another type, and no type turns into another by itself"
_WHERE = "where the value comes from: the command line, the launch file or the file of parameters"
_KNOWN = tuple(
    (re.compile(error), why, cure)
    for error, why, cure in (
        (
            r"AttributeError: 'NoneType' object has no attribute '(\w+)'",
            r"what stands before .\1 in this line is None: not set yet, or what a function returned",
            r"give it a value before this line runs, or ask first whether it is None",
        ),
        (
            rf"{_OTHER_TYPE} of type '\w+', expecting type '(\w+)'.*",
            _OVERRIDDEN,
            rf"give \1 a value of type \3 {_WHERE}",
        ),
        (
            rf"{_OTHER_TYPE} of type 'INTEGER', expecting type 'DOUBLE'.*",
            _OVERRIDDEN,
            rf"write \1:=\2.0 in place of \1:=\2 {_WHERE}",
        ),
        (
            r"RuntimeError: (?:no running event loop|await wasn't used with future"
            r"|There is no current event loop in thread '(?!MainThread').*)"
            r"|TypeError: Expected coroutine to yield a Future or None, got: .*",
            r"an executor of rclpy resumes coroutines itself, and runs no event loop of asyncio",
            r"await only futures of rclpy, such as that of call_async(), and several one after another; in "
            r"place of asyncio.sleep(), await a rclpy.task.Future that a timer completes",
        ),
        (
            rf"AttributeError: (?:property|can't set attribute) '({_NODE_PROPERTIES})'"
            r"(?: of '\w+' object has no setter)?",
            _OF_NODES,
            _OTHER_NAME,
        ),
        (
            r"AttributeError: (handle) cannot be modified after node creation",
            _OF_NODES,
            _OTHER_NAME,
        ),
        (
            r"AttributeError: 'NoneType' object has no attribute 'successful'",
            r"the callback of add_on_set_parameters_callback() returned nothing; rclpy needs its answer",
            r"end that callback with: return SetParametersResult(successful=True)",
        ),
        (
            r"TypeError: CallbackGroup\.add_entity\(\) missing 1 required positional argument: 'entity'",
            r"the class of a callback group was handed over in place of a group",
            r"make a group of the class by parentheses, such as ReentrantCallbackGroup()",
        ),
        (
            NO_FLOAT.pattern,
            r"a field of type float takes no int, and no bool: 1 is an int",
            r"write a float: 1.0 in place of 1, or float(...)",
        ),
        (
            NO_RESULT.pattern,
            r"an action's execute callback returned no \1.Result, which is what rclpy sends",
            r"end that callback with: return \1.Result()",
        ),
        (
            r"TypeError: 'NoneType' object does not support the context manager protocol",
            r"what this with statement is given is None; rclpy.init() returns nothing up to Jazzy",
            r"if this is with rclpy.init(), call it alone, and rclpy.shutdown() at the end; as it is, it "
            r"works from Kilted on (--distro kilted)",
        ),
        (
            r"TypeError: Node\.__init__\(\) missing 1 required positional argument: 'node_name'",
            r"a node has a name, by which others know it",
            r"give it one: super().__init__('my_node')",
        ),
        (
            r"TypeError: Node\.(create_\w+)\(\) missing 1 required positional argument: 'qos_profile'",
            r"\1() has to know how many messages a queue holds, or a whole QoSProfile",
            r"give it as the last argument, such as 10",
        ),
        (
            r"TypeError: Node\.(create_\w+)\(\) takes \d+ positional arguments but \d+ were given",
            r"\1() takes the callback group, and what follows it, by name alone",
            r"name the argument: callback_group=...",
        ),
        (
            r"TypeError: float\(\) argument must be a string or a real number, not '(?:method|function)'",
            r"a function is no number; create_timer() takes the period in seconds first, then the callback",
            r"if this makes a timer, swap the two: create_timer(0.5, self.tick)",
        ),
        (
            r"TypeError: Expected <class '[\w.]+\.(\w+)'>, got <class '[\w.]+'>",
            r"a publisher of \1 publishes messages of that class, and no bare values",
            r"make a \1(), set its fields, and publish that",
        ),
        (
            SPUN_TWICE,
            r"another thread is in the same generator; where this line spins, it spins the same executor",
            r"spin an executor in one thread only, and let the others wait for that one to end",
        ),
        (
            r"RuntimeError: Context must be initialized before it can be shutdown",
            r"rclpy is not initialised by then: it was shut down before, or init() was not called",
            r"to shut down what may be shut down already, call rclpy.try_shutdown()",
        ),
        (
            r"ParameterNotDeclaredException: .*parameter\(s\): (\w+)",
            r"a node has only the parameters that it declares",
            r"declare it first, in __init__: self.declare_parameter('\1', ...) with its default",
        ),
        (
            r"InvalidNodeNameException: .*",
            r"the name of a node has only letters, digits and underscores, and does not begin with a digit",
            r"give the node another name, such as my_node",
        ),
        (
            r"RuntimeError: (dictionary|Set|deque) (?:changed size|mutated) during iteration",
            r"the \1 was changed while this line went through it, by this loop or by another thread",
            r"go through a copy, such as list(...) of it; and where another thread changes it, hold one lock "
            r"around both places",
        ),
        (
            r"TypeError: isinstance\(\) arg 2 must be a type, a tuple of types, or a union",
            r"publish() asks isinstance() about the class that create_publisher() was given",
            r"if this line publishes, give create_publisher() the class itself: Int32, not Int32()",
        ),
        (
            r"InvalidHandle: cannot use Destroyable because destruction was requested",
            r"what this line uses was destroyed before, itself or with its node",
            r"destroy it only when nothing uses it any more, or make it again before this line",
        ),
        (
            r"RCLError: [Ff]ailed to create (\w+): (?:invalid allocator|.* with incompatible type).*",
            r"within one process a topic or service has one type: most likely something else of the program "
            r"uses the name of this \1 with another type",
            r"give all ends of that name the same type, or this \1 another name",
        ),
        (
            r"EOFError: EOF when reading a line",
            r"nobody types into this run, so input() found the end of what there is to read",
            r"run it where somebody can type; in a callback, which keeps its thread so long, read in another "
            r"thread",
        ),
    )
)
"""Exceptions worded alike in every program, each with the reason and the cure; the last that fits counts."""
