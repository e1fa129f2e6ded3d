"""An action of the bar of which only the look matters."""

from app.theme.icons import Icon
from app.widgets.action_bar import BarAction


def idle(text: str, key: str = "", icon: Icon | None = None, *, is_wished: bool = True) -> BarAction:
    return BarAction(text, _do_nothing, key, icon, is_wished=is_wished)


def _do_nothing() -> None:
    """Nothing."""
