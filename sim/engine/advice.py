"""What a learner most likely has to do about a program that failed or did nothing, in half a sentence."""

from sim.ros.process import current_process


def advice_on(error: BaseException) -> str:
    """What to add to an exception's text; empty where that says it all."""
    if isinstance(error, ModuleNotFoundError) and error.name is not None:
        return _on_missing(error.name.partition(".")[0])
    return ""


def _on_missing(package: str) -> str:
    from sim.ros.interfaces import known_packages_sentence

    return f"; {known_packages_sentence(package)}"


def silence() -> str:
    """How a program of the calling thread's process ended that made callbacks and never spun; else empty."""
    process = current_process()
    if process.callbacks == 0 or process.spins > 0:
        return ""
    return "the program returned without spinning, so none of its callbacks ran; call rclpy.spin(node) before"
