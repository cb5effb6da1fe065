"""Names of callbacks as people say them."""


def short_name(callback: str) -> str:
    """Return a callback's name without the ending that most of them share: ``odom`` for ``odom_callback``."""
    return callback.removesuffix("_callback") or callback
