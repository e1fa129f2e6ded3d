"""A button with icon, word and key cap. Filled only if pressing it is what we wish."""

from dataclasses import replace
from typing import Any

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QKeyEvent
from PySide6.QtWidgets import QPushButton, QSizePolicy, QStyle, QStyleOptionButton, QWidget

from app.style import ButtonFace
from app.style import Kind as Kind
from app.theme import Look
from app.widgets.icons import Icon
from app.wording import tr

HEIGHT = 48


class FacedButton(QPushButton):
    """What all our buttons have in common: the style paints their face. `key` is what a cap shows."""

    def __init__(
        self,
        look: Look,
        text: str,
        kind: Kind,
        icon: Icon | None = None,
        key: str = "",
        height: float = HEIGHT,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(text, parent)
        self._look, self.face = look, ButtonFace(kind, height, icon, key)
        self.setAccessibleName(text)
        self.setAutoDefault(False)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)
        self.setSizePolicy(QSizePolicy.Policy.Minimum, QSizePolicy.Policy.Fixed)
        self.setAttribute(Qt.WidgetAttribute.WA_Hover)

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


class Button(FacedButton):
    """Pressed by Enter and Space; a shortcut itself belongs to the window, which knows when it holds."""

    def __init__(
        self,
        look: Look,
        text: str,
        kind: Kind = Kind.SECONDARY,
        icon: Icon | None = None,
        key: str = "",
        height: float = HEIGHT,
        parent: QWidget | None = None,
    ) -> None:
        super().__init__(look, text, kind, icon, key, height, parent)
        self.setAccessibleDescription(tr("Key {key}").format(key=key) if key else "")

    @property
    def key(self) -> str:
        return self.face.key

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() in (Qt.Key.Key_Return, Qt.Key.Key_Enter):
            self.click()
            return
        super().keyPressEvent(event)
