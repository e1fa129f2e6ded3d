"""Accessible roles of the application's own widgets, for assistive technology.

Qt knows the roles of its own controls only.

A class that paints itself reports it by `accessible_role`; every other keeps the role that Qt gives it. Name and
description are the widget's own.
"""

from PySide6.QtCore import QObject
from PySide6.QtGui import QAccessible, QAccessibleInterface
from PySide6.QtWidgets import QAccessibleWidget, QWidget

ATTRIBUTE = "accessible_role"


def show_roles() -> None:
    """Let Qt ask for the roles of our widgets; once for the application."""
    QAccessible.installFactory(_interface_of)


def _interface_of(_class_name: str, one: QObject) -> QAccessibleInterface | None:
    role = getattr(type(one), ATTRIBUTE, None)
    if role is None or not isinstance(one, QWidget):
        return None
    return QAccessibleWidget(one, role)
