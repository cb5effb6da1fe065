"""Actions that are not supported; creating one raises an error."""

from sim.launch.errors import COMPILED, unsupported

ComposableNodeContainer = unsupported("ComposableNodeContainer", COMPILED)
LoadComposableNodes = unsupported("LoadComposableNodes", COMPILED)
LifecycleTransition = unsupported(
    "LifecycleTransition", ": a launch does not follow the states of its nodes; use ros2 lifecycle set"
)
ROSTimer = RosTimer = unsupported("ROSTimer", "; use TimerAction, which keeps the run's time")
