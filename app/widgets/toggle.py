"""Something that is on or off: with a check mark before its word while it is on."""

from PySide6.QtCore import QSignalBlocker

from app.widgets.button import Button, ButtonKind

HEIGHT = 52  # as high as the controls beside it


class Toggle(Button):
    def __init__(self, text: str, key: str, is_on: bool) -> None:
        super().__init__(text, ButtonKind.TOGGLE, key=key, height=HEIGHT)
        self.setCheckable(True)
        self.setChecked(is_on)

    def show_on(self, is_on: bool) -> None:
        """Show what is so already, without telling anybody."""
        with QSignalBlocker(self):
            self.setChecked(is_on)
