"""Fields that name a clinic's library: which server, and where the recordings are."""

from PySide6.QtCore import QObject, Signal
from PySide6.QtWidgets import QWidget

from app.widgets.field import Field
from app.wording.translation import tr

ADDRESS = "postgresql://user@server/database"


class ServerFields(QObject):
    """The password has a field of its own: nobody has to write it into an address, where everybody reads it."""

    entered = Signal()  # by Enter

    def __init__(self, place: str, parent: QWidget, *, is_place_optional: bool) -> None:
        """`place` is what the field of the recordings' place is called. `parent` lays the fields out."""
        super().__init__(parent)
        self._is_place_optional = is_place_optional
        self.address = Field(tr("Address of the clinic's server"), placeholder=ADDRESS)
        self.password = Field(tr("Server password, if required"), is_secret=True)
        self.place = Field(place, is_optional=is_place_optional)
        for field in self.fields:
            field.edited.connect(self._on_edited)
            field.line_edit.returnPressed.connect(self.entered)

    @property
    def fields(self) -> tuple[Field, Field, Field]:
        return self.address, self.password, self.place

    @property
    def tab_order(self) -> list[QWidget]:
        return [field.line_edit for field in self.fields]

    @property
    def reported(self) -> tuple[str, str, str]:
        """Address, password and place, as they were typed."""
        return self.address.text.strip(), self.password.text, self.place.text.strip()

    @property
    def is_complete(self) -> bool:
        """Whether what has to be typed is; what is missing is stated at its field."""
        missing = [(self.address, tr("Enter the address of the clinic's server."))]
        if not self._is_place_optional:
            missing.append((self.place, tr("Enter a folder that all workstations can access, or s3://bucket/folder.")))
        wrong = [(field, sentence) for field, sentence in missing if not field.text.strip()]
        for field, sentence in wrong:
            field.set_wrong(sentence)
        if wrong:
            wrong[0][0].setFocus()
        return not wrong

    def refuse(self, sentence: str, *, is_place: bool = False) -> None:
        """Say why the server, or the recordings' place, cannot be used."""
        field = self.place if is_place else self.address
        field.set_wrong(sentence)
        field.setFocus()

    def forget_typed(self) -> None:
        for field in self.fields:
            field.set_text("")
            field.set_wrong("")

    def _on_edited(self, _text: str) -> None:
        for field in self.fields:
            field.set_wrong("")
