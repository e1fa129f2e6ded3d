"""Check where wrappers of Qt's objects end: on the screen's thread alone, as `app/workers/garbage.py` has it.

PySide deletes one that ends on another thread at whatever instruction the screen's thread comes to next: inside a
paint, or of a widget that is being looked at. Such a crash comes once in many runs; where a wrapper ended is seen at
once.
"""

import threading
import traceback
from dataclasses import dataclass, field
from typing import Any
from weakref import ref

from PySide6.QtCore import QObject


class _Wrapper(ref[QObject]):
    __slots__ = ("kind",)

    kind: type[QObject]


@dataclass(slots=True)
class Wrappers:
    """All that Python makes of `QObject` and its kinds once `watch` was called, while they last."""

    _there: set[_Wrapper] = field(default_factory=set)
    _elsewhere: list[str] = field(default_factory=list)

    def watch(self) -> None:
        """Note each from when it is made: the class of Qt's classes makes their objects."""

        def make(kind: type, *arguments: object, **named: object) -> object:
            made = type.__call__(kind, *arguments, **named)
            if isinstance(made, QObject):
                wrapper = _Wrapper(made, self._on_end)
                wrapper.kind = kind
                self._there.add(wrapper)
            return made

        classes_of_qt: Any = type(QObject)
        classes_of_qt.__call__ = make

    def taken(self) -> list[str]:
        """What ended on another thread since this was asked last: its class, the thread, and the last calls there."""
        taken, self._elsewhere = self._elsewhere, []
        return taken

    def _on_end(self, wrapper: Any) -> None:
        self._there.discard(wrapper)
        if threading.current_thread() is not threading.main_thread():
            where = "".join(traceback.format_stack(limit=6)[:-1])
            thread = threading.current_thread().name
            self._elsewhere.append(f"{wrapper.kind.__qualname__} ended on the thread {thread!r}:\n{where}")
