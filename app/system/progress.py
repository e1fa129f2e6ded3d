"""How far work that takes long has come."""

from collections.abc import Callable

Report = Callable[[float, str], None]
"""Called with the share done (0 to 1) and what is being done. What it raises ends the work."""


def nobody(_share: float, _what: str) -> None:
    """Report to nobody."""
