"""Form for the sensors' memories: what they hold, whether it is kept, and what becomes of it."""

from collections.abc import Sequence
from dataclasses import dataclass

from PySide6.QtWidgets import QVBoxLayout, QWidget

from app.theme.current import scaled
from app.theme.icons import Icon
from app.widgets.card import Card
from app.widgets.lay_out import lay_out
from app.widgets.notice import Notice
from app.widgets.table import CellTable, TableColumn, TableRow
from app.widgets.table_cells import TextCell
from app.widgets.text import SEMIBOLD, Text
from app.wording.translation import tr, tr_n

ROW, HEAD, PADDING = 48, 32, 10
AT_LEAST_ROWS = 2


@dataclass(frozen=True, slots=True)
class HeldLine:
    """One recording in the memories: when it was begun, how many sensors hold a part of it, and what is known of it."""

    begun: str
    sensors: int
    note: str
    is_kept: bool
    can_fetch: bool = False


class MemoriesForm(QWidget):
    def __init__(self) -> None:
        super().__init__()
        self._lines: tuple[HeldLine, ...] = ()
        self._title = Text(size=20, weight=SEMIBOLD, wraps=True)
        self._lead = Text(size=14, tone="ink2", wraps=True)
        self.list = CellTable(tr("Recordings in the sensors"), row=ROW, head=HEAD, padding=PADDING, is_list=True)
        self.notice = Notice(size=16)
        card = Card()
        lay_out(card.column, self._title, self._lead, self.notice, (self.list, 1), 0)  # the 0: where there is no list
        lay_out(QVBoxLayout(self), (card, 1), margins=0)
        scaled(self.list.setMinimumHeight, HEAD + AT_LEAST_ROWS * ROW)
        self.show_message("")
        self.show_lines(())

    @property
    def tab_order(self) -> list[QWidget]:
        return [self.list]

    @property
    def title(self) -> str:
        return self._title.text()

    @property
    def chosen_number(self) -> int:
        """Of the line that is chosen, from 0; -1: none."""
        return self.list.currentIndex().row()

    def focus(self) -> None:
        (self.list if self._lines else self).setFocus()  # else Enter would press the button that is next

    def show_lines(self, lines: Sequence[HeldLine]) -> None:
        """Show these, oldest first; the first that can be fetched is chosen."""
        self._lines = tuple(lines)
        heads = [tr("Started"), tr("Sensors")]
        columns = [TableColumn(TextCell(head, size=12, tone="ink2")) for head in heads]
        columns.append(TableColumn(TextCell(tr("Status"), size=12, tone="ink2", wraps=True), share=1))
        self.list.show_rows(columns, [_row(number, line) for number, line in enumerate(lines)])
        self.list.setVisible(bool(lines))
        required = [number for number, line in enumerate(lines) if line.can_fetch]
        if lines:
            self.list.choose(required[0] if required else 0)
        count = len(lines)
        title = tr("The sensor memory is empty")
        if count:
            title = tr_n(
                "{count} recording in the sensor memory",
                "{count} recordings in the sensor memory",
                count,
            ).format(count=count)
        self._title.setText(title)
        self._lead.setText(tr("Erasing clears the whole memory of a sensor.") if count else "")
        self._lead.setVisible(bool(count))

    def show_unknown(self, what: str, then: str) -> None:
        """Say why it is not known what they hold, and what to do."""
        self.show_lines(())
        self._title.setText(tr("The content of the sensor memory is unknown"))
        self.show_message(what, then)

    def show_message(self, what: str, then: str = "") -> None:
        """Say what is the matter, and what to do; "" takes it back."""
        self.notice.show_message(Icon.WARNING if what else None, what, then, is_caution=bool(what))
        self.notice.setVisible(bool(what))


def _row(number: int, line: HeldLine) -> TableRow:
    count = tr_n("{count} sensor", "{count} sensors", line.sensors).format(count=line.sensors)
    note = TextCell(line.note, wraps=True, mark=Icon.CHECK if line.is_kept else Icon.WARNING)
    return TableRow((TextCell(line.begun), TextCell(count), note), key=number)
