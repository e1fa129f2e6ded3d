"""Duration of a transition: nothing where less motion is asked for, here or in the system."""

import ctypes
import sys

from PySide6.QtWidgets import QApplication, QStyle

from app.theme.theme import Theme


def duration_ms(usual_ms: int, theme: Theme) -> int:
    """Give how long a transition of `usual_ms` may take: all of it, or 0."""
    return usual_ms if not theme.has_less_motion and _is_motion_required() else 0


def _is_motion_required() -> bool:
    if sys.platform == "win32":
        is_required = ctypes.c_int(1)
        spi_getclientareaanimation = 0x1042  # "Show animations in Windows"
        ctypes.windll.user32.SystemParametersInfoW(spi_getclientareaanimation, 0, ctypes.byref(is_required), 0)
        return bool(is_required.value)
    return QApplication.style().styleHint(QStyle.StyleHint.SH_Widget_Animation_Duration) > 0
