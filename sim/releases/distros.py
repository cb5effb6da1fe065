"""The distributions of ROS 2 that the model can be like, and the patches of their rclpy."""

import re

DISTROS = {"humble": "3.3.22", "jazzy": "7.1.12", "kilted": "9.1.2", "lyrical": ""}
"""The distributions, each with the patch that its name alone stands for; Lyrical's patches are not known."""

COMPARED_DISTROS = ("jazzy", "kilted")
"""The distributions whose real rclpy was compared with the model."""


class UnknownProfileError(ValueError):
    """There is no such distribution, or no such patch of it; the text is a sentence on that."""


def distro_and_patch(name: str) -> tuple[str, str]:
    """Return the two parts of a name such as ``kilted`` or ``jazzy@7.1.5``.

    Raises:
        UnknownProfileError: there is no such distribution or patch.
    """
    distro, _, patch = name.partition("@")
    usual = DISTROS.get(distro)
    if usual is None:
        *others, last = DISTROS
        give = f"{', '.join(others)} or {last}"
        raise UnknownProfileError(f"{distro!r} is no distribution; give {give}")
    if "@" not in name:
        return distro, usual
    line = usual.rpartition(".")[0]
    if not line:
        raise UnknownProfileError(f"which patches {distro} has is not known; give {distro} alone")
    if not re.fullmatch(rf"{re.escape(line)}\.\d{{1,4}}", patch):
        raise UnknownProfileError(f"{distro} has no rclpy {patch!r}; give one like {distro}@{usual}")
    return distro, patch
