"""Actions that are not supported: each says so when a launch file makes one."""


class ComposableNodeContainer:
    """Not supported: components are compiled from C++."""

    def __init__(self, *_: object, **__: object) -> None:
        raise NotImplementedError(
            "ComposableNodeContainer is not supported: components are compiled from C++"
        )


class LoadComposableNodes:
    """Not supported: components are compiled from C++."""

    def __init__(self, *_: object, **__: object) -> None:
        raise NotImplementedError("LoadComposableNodes is not supported: components are compiled from C++")


class LifecycleTransition:
    """Not supported: a launch does not follow the states of its nodes."""

    def __init__(self, *_: object, **__: object) -> None:
        raise NotImplementedError(
            "LifecycleTransition is not supported: a launch does not follow the states of its nodes; "
            "use ros2 lifecycle set"
        )


class ROSTimer:
    """Not supported: a TimerAction keeps the run's time already."""

    def __init__(self, *_: object, **__: object) -> None:
        raise NotImplementedError("ROSTimer is not supported; use TimerAction, which keeps the run's time")


class RosTimer(ROSTimer):
    """Not supported, as ROSTimer."""
