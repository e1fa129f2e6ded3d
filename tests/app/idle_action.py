"""An action of the bar of which only the look matters."""

from app.theme.icons import Icon
from app.widgets.action_bar import BarAction


def idle(text: str, key: str = "", icon: Icon | None = None, *, is_requested: bool = True) -> BarAction:
    return BarAction(text, _do_nothing, key, icon, is_requested=is_requested)


def _do_nothing() -> None:
    """Nothing."""
