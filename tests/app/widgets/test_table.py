"""The one table: what its cells paint and say, how it is on a page, and how a list of it is worked by keys."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import pytest
from PySide6.QtCore import QRectF, Qt
from PySide6.QtGui import QColor, QImage, QPainter
from PySide6.QtTest import QTest
from PySide6.QtWidgets import QApplication
from pytestqt.qtbot import QtBot

from app.theme.current import current_theme, set_dark, set_scale
from app.theme.icons import Icon
from app.theme.theme import Theme
from app.widgets.table import CellTable, TableColumn, TableRow
from app.widgets.table_cells import CENTRE, EMPTY, LEFT, RIGHT, STRIP_WIDTH, ErrorStrip, TableCell, TextCell
from app.widgets.text import SEMIBOLD
from core.body import Side

ERROR_DEG = 9.2
COLUMNS = (
    TableColumn(TextCell("Largest differences", weight=SEMIBOLD), share=1),
    TableColumn(TextCell("L \N{MINUS SIGN} R", align=RIGHT, size=12, tone="ink2")),
    TableColumn(TextCell("grey: error", align=CENTRE, size=12, tone="ink2"), share=2),
)


def strip(difference_deg: float, *, is_judged: bool = True) -> ErrorStrip:
    return ErrorStrip(difference_deg, ERROR_DEG, 1.8 * ERROR_DEG, is_judged, "12.1 of error 9.2")


def row(name: str, difference: str, *, is_marked: bool = False, hint: str = "") -> TableRow:
    figure = TextCell(difference, align=RIGHT, mark=Icon.WARNING if is_marked else None, spoken=f"{name}: {difference}")
    return TableRow((TextCell(name), figure, strip(-12.1)), key=name, hint=hint)


def table_of(qtbot: QtBot, rows: Sequence[TableRow], *, is_list: bool = False) -> CellTable:
    table = CellTable("Differences", is_list=is_list)
    qtbot.addWidget(table)
    table.show_rows(COLUMNS, rows)
    table.resize(640, 200 if is_list else table.height())
    with qtbot.waitActive(table):
        table.show()
        table.activateWindow()
    return table


def painted(cell: TableCell, theme: Theme, width: int = STRIP_WIDTH) -> QImage:
    image = QImage(width, 28, QImage.Format.Format_RGB32)
    image.fill(QColor(theme.colours.surface))
    painter = QPainter(image)
    cell.paint(painter, QRectF(image.rect()), theme)
    painter.end()
    return image


def colour(image: QImage, x: float, y: float = 14) -> str:
    return image.pixelColor(round(x), round(y)).name().upper()


def is_ink(image: QImage, x: float, y: float = 14) -> bool:
    """Return whether a line in ink, whose edges are smoothed, goes through a pixel of a light theme."""
    return image.pixelColor(round(x), round(y)).lightness() < 80


def x_of(value_deg: float) -> float:
    """The place of a difference in a strip of its least width; the dot is 11 px wide."""
    return STRIP_WIDTH / 2 + value_deg / (1.8 * ERROR_DEG) * (STRIP_WIDTH - 11) / 2


def test_a_dot_outside_the_error_is_filled_and_one_inside_is_hollow() -> None:
    c = current_theme().colours
    outside, inside = painted(strip(-12.1), current_theme()), painted(strip(7.0), current_theme())
    assert colour(outside, x_of(-12.1)) == c.ink
    assert colour(inside, x_of(7.0)) == c.surface
    assert is_ink(inside, x_of(3.5))  # the line from zero
    for image in (outside, inside):
        assert colour(image, x_of(ERROR_DEG) - 2, 7) == c.band_2sd
        assert colour(image, x_of(ERROR_DEG) + 2, 7) == c.surface
    assert strip(-12.1).exceeds
    assert not strip(7.0).exceeds


def test_what_is_not_judged_is_a_grey_bar_without_error_and_dot() -> None:
    c, cell = current_theme().colours, strip(-12.1, is_judged=False)
    image = painted(cell, current_theme())
    assert colour(image, x_of(-6.0)) == c.control
    assert {colour(image, x, y) for x in range(image.width()) for y in range(image.height())}.isdisjoint(
        {c.ink, c.band_2sd}
    )
    assert not cell.exceeds


def test_what_lies_beyond_the_strip_ends_there_in_an_arrow() -> None:
    """A dot at the edge would be read as a difference of that size."""
    beyond, at_edge = painted(strip(38.0), current_theme()), painted(strip(1.8 * ERROR_DEG), current_theme())
    edge = x_of(1.8 * ERROR_DEG)
    assert is_ink(at_edge, edge, 11)
    assert not is_ink(beyond, edge, 11)
    assert is_ink(beyond, edge - 8)


@pytest.mark.parametrize("unknown", [(math.nan, ERROR_DEG, 16.0), (5.0, math.nan, math.nan), (0.0, 0.0, 0.0)])
def test_a_strip_of_what_is_not_known_has_no_dot(unknown: tuple[float, float, float]) -> None:
    """Nothing is known of where it would lie; a difference of none, without error, is a dot at zero."""
    image = painted(ErrorStrip(*unknown, is_judged=True), current_theme())
    away_from_zero = [x for x in range(image.width()) if abs(x - STRIP_WIDTH / 2) > 8]
    assert all(not is_ink(image, x) for x in away_from_zero)


@pytest.mark.parametrize("scale", [1.0, 2.0])
@pytest.mark.parametrize("align", [LEFT, RIGHT, CENTRE])
def test_a_text_cell_paints_all_of_itself_into_the_width_that_it_asks_for(
    align: Qt.AlignmentFlag, scale: float
) -> None:
    set_scale(scale)
    theme = current_theme()
    cell = TextCell("49.3", "± 1.8", align, 15, SEMIBOLD, mark=Icon.WARNING, side=Side.LEFT)
    width = cell.width(theme)
    tight, wide = painted(cell, theme, width + 2), painted(cell, theme, width + 202)
    ink = [x for x in range(wide.width()) if any(colour(wide, x, y) != theme.colours.surface for y in range(28))]
    beginning = {LEFT: 0, RIGHT: 202, CENTRE: 101}[align]
    assert beginning <= ink[0]
    assert ink[-1] <= beginning + width + 1
    assert len({x for x in range(tight.width()) if colour(tight, x) == theme.colours.left_text}) > 0


def test_a_text_of_two_lines_asks_for_their_height() -> None:
    one, two = TextCell("free motion"), TextCell("free motion,\nwalking")
    assert two.height(current_theme()) > one.height(current_theme())
    assert two.width(current_theme()) < TextCell("free motion, walking").width(current_theme())
    assert two.words == "free motion, walking"


def test_a_table_is_as_high_as_its_rows_and_shares_all_of_its_width(qtbot: QtBot) -> None:
    table = table_of(qtbot, [row("Knee range", "+2.0"), row("Peak knee flexion, swing", "−12.1", is_marked=True)])
    assert table.height() == 32 + 2 * 28
    widths = [table.columnWidth(column) for column in range(3)]
    needed = table.needed_widths
    assert sum(widths) == 640
    assert widths[1] == needed[1]
    assert abs((widths[2] - needed[2]) - 2 * (widths[0] - needed[0])) <= 2
    set_scale(2.0)
    assert table.height() == 2 * (32 + 2 * 28)
    assert table.minimumWidth() == sum(table.needed_widths)


def test_every_cell_is_stated_with_its_row_and_column(qtbot: QtBot) -> None:
    table = table_of(qtbot, [row("Knee range", "+2.0", hint="Over the whole stride."), row("Swing", "−12.1")])
    model = table.model()
    stated = Qt.ItemDataRole.AccessibleTextRole
    assert model.index(0, 0).data(stated) == "Knee range"
    assert model.index(1, 1).data(stated) == "Swing: −12.1"
    assert model.index(1, 2).data(stated) == "12.1 of error 9.2"
    assert model.index(0, 1).data(Qt.ItemDataRole.ToolTipRole) == "Over the whole stride."
    assert model.index(1, 1).data(Qt.ItemDataRole.ToolTipRole) is None
    assert model.headerData(1, Qt.Orientation.Horizontal) == "L − R"
    QTest.keyClick(table, Qt.Key.Key_C, Qt.KeyboardModifier.ControlModifier)
    assert QApplication.clipboard().text().split("\n")[1:] == ["Knee range\t+2.0\t", "Swing\t−12.1\t"]


@pytest.mark.parametrize("is_dark", [False, True])
def test_a_cell_that_was_clicked_stays_readable(qtbot: QtBot, is_dark: bool) -> None:
    """Qt fills what is chosen with the palette's dark highlight before a cell is painted in ink."""
    table = table_of(qtbot, [row("Knee range", "+2.0")])
    set_dark(is_dark)
    before = table.grab().toImage()
    middle = table.visualRect(table.cells.index(0, 0)).center()
    QTest.mouseClick(table.viewport(), Qt.MouseButton.LeftButton, pos=middle)
    assert table.currentIndex().isValid()
    assert table.grab().toImage() == before


def test_a_heading_goes_over_all_columns_and_widens_none(qtbot: QtBot) -> None:
    heading = TextCell("A heading that is much longer than the names of the rows", span=3)
    table = table_of(qtbot, [row("Knee", "+2.0")])
    before = table.needed_widths
    table.show_rows(COLUMNS, [TableRow((heading, EMPTY, EMPTY), is_heading=True), row("Knee", "+2.0")])
    assert table.columnSpan(0, 0) == 3
    assert table.needed_widths == before
    table.show_rows(COLUMNS, [row("Knee", "+2.0")])
    assert table.columnSpan(0, 0) == 1


def test_a_list_is_worked_by_keys(qtbot: QtBot) -> None:
    table = table_of(qtbot, [row(f"row {number}", "0.0") for number in range(40)], is_list=True)
    chosen: list[object] = []
    opened: list[object] = []
    table.chosen.connect(chosen.append)
    table.opened.connect(opened.append)
    assert table.key == "row 0"  # with the focus
    for key in (Qt.Key.Key_End, Qt.Key.Key_Up, Qt.Key.Key_Return, Qt.Key.Key_Home, Qt.Key.Key_Right, Qt.Key.Key_Down):
        QTest.keyClick(table, key)
    assert chosen == ["row 39", "row 38", "row 0", "row 1"]
    assert opened == ["row 38"]
    assert table.key == "row 1"


def test_rows_that_stay_keep_the_focus_and_others_take_it(qtbot: QtBot) -> None:
    table = table_of(qtbot, [row("knee", "1.0"), row("ankle", "2.0")], is_list=True)
    table.choose(1)
    table.show_rows(COLUMNS, [row("knee", "1.0"), row("ankle", "9.9")])
    assert table.key == "ankle"
    assert table.cells.index(1, 1).data() == "9.9"
    table.show_rows(COLUMNS, [row("knee", "1.0"), row("hip", "2.0")])
    assert table.key is None


@dataclass(frozen=True, slots=True)
class Counted(TableCell):
    """A cell that counts how often cells of its list are measured and painted."""

    counts: dict[str, int] = field(hash=False)

    def width(self, _theme: Theme) -> int:
        self.counts["measured"] += 1
        return 40

    def paint(self, _painter: QPainter, _room: QRectF, _theme: Theme) -> None:
        self.counts["painted"] += 1


def test_of_thousands_of_rows_only_those_in_sight_are_painted_and_none_is_measured(qtbot: QtBot) -> None:
    counts = {"measured": 0, "painted": 0}
    table = CellTable("Many", head=0, is_list=True)
    qtbot.addWidget(table)
    column = TableColumn(share=1, widest=EMPTY)
    table.show_rows([column], [TableRow((Counted(counts),), key=number) for number in range(5000)])
    table.resize(400, 280)
    with qtbot.waitExposed(table):
        table.show()
    table.grab()
    assert counts["measured"] == 0
    assert 10 <= counts["painted"] <= 3 * 11
    assert table.columnWidth(0) == table.viewport().width()
