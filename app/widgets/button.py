"""A button with icon, word and key cap. Filled only if pressing it is what we wish."""

from dataclasses import replace
from typing import Any

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QPushButton, QSizePolicy, QStyle, QStyleOptionButton, QWidget

from app.theme.icons import Icon
from app.theme.style import ButtonFace
from app.theme.style import ButtonKind as ButtonKind
from app.wording.translation import tr

HEIGHT = 48
CHOICES = (ButtonKind.SEGMENT, ButtonKind.CHIP, ButtonKind.LABEL)  # Enter belongs to the page they are on


class Button(QPushButton):
    """`key` is what the cap shows; the shortcut itself belongs to the window, which knows when it holds."""

    def __init__(
        self,
        text: str,
        kind: ButtonKind = ButtonKind.SECONDARY,
        icon: Icon | None = None,
        key: str = "",
        height: float = HEIGHT,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(text, parent)
        self.face = ButtonFace(kind, height, icon, key)
        self.setAccessibleName(text)
        self.setAccessibleDescription(tr("Key {key}").format(key=key) if key else "")
        self.setAutoDefault(False)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Minimum, QSizePolicy.Policy.Fixed)
        self.setAttribute(Qt.WidgetAttribute.WA_Hover)

    @property
    def key(self) -> str:
        return self.face.key

    def set_face(self, **changes: Any) -> None:
        """Show another kind, icon, key, note or height."""
        face = replace(self.face, **changes)
        if face != self.face:
            self.face = face
            self.updateGeometry()
            self.update()

    def sizeHint(self) -> QSize:
        option = QStyleOptionButton()
        self.initStyleOption(option)  # Qt would keep the size while face and check change
        return self.style().sizeFromContents(QStyle.ContentsType.CT_PushButton, option, QSize(), self)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        is_enter = event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter)
        if is_enter and self.face.kind not in CHOICES:
            self.click()
            return
        super().keyPressEvent(event)
