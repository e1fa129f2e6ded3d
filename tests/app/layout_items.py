"""Layout items from before a widget was moved that PySide still holds. That can end the process later.

`outer.addLayout(inner)`, where `inner` is filled already, gives each item of `inner` a wrapper that `outer` keeps. Qt
deletes an item when its widget is put elsewhere; its wrapper learns of that only from `removeWidget` and `takeAt`. An
object that comes to lie at the item's address shares its entry in PySide's map, and when Qt deletes that object PySide
6.11 touches freed memory: a segmentation fault in whatever `deleteLater` that is.
"""

from PySide6.QtWidgets import QLayout, QWidget, QWidgetItem
from shiboken6 import Shiboken


def items_held() -> set[int]:
    """The addresses of all layout items that PySide holds a wrapper of."""
    return {Shiboken.getCppPointer(one)[0] for one in Shiboken.getAllValidWrappers() if isinstance(one, QWidgetItem)}


def item_of(widget: QWidget, layout: QLayout) -> int:
    """The address of the item that `layout` holds `widget` in. Asked after `items_held`: it makes a wrapper."""
    item = layout.itemAt(layout.indexOf(widget))
    assert item is not None
    return Shiboken.getCppPointer(item)[0]
