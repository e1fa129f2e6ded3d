"""The differences of a comparison as a picture and as a table, on a card that scrolls where it is too low."""

from collections.abc import Sequence

from PySide6.QtWidgets import QHBoxLayout, QSizePolicy, QVBoxLayout, QWidget

from app.plots.difference_plot import DifferencePlot
from app.results.compared_plot import comparison_groups, side_groups
from app.results.compared_table import comparison_table, has_brief_table, side_table
from app.summary.comparison import Comparison, Contrast, SideRow
from app.theme.current import px
from app.widgets.card import Card
from app.widgets.lay_out import lay_out
from app.widgets.reading_area import scrolled
from app.widgets.table import CellTable
from app.widgets.text import SEMIBOLD, Text
from app.widgets.toggle import Toggle
from app.wording.translation import tr
from core.body import Side

LEAST, LEAST_IF_SPACIOUS = 312, 460  # px wide
PADDING, SCROLL_BAR = 16, 14
TOGGLE = 44  # px high
MOST_VALUES, MOST_VALUES_IF_COMPACT = 5, 3  # visits with a column of their own
WIDEST = 16_777_215  # Qt's own


class ComparedCard(Card):
    """Between visits the table is brief where there is no room for all measures, until all are asked for."""

    def __init__(self) -> None:
        super().__init__(padding=PADDING)
        self.title = Text(size=16, weight=SEMIBOLD)
        self.all_measures = Toggle(tr("All measures"), "", is_on=False)
        self.all_measures.set_face(height=TOGGLE)
        self.plot = DifferencePlot()
        self.table = CellTable(tr("Differences"))
        self._found: Comparison | None = None
        self._is_compact = self._is_spacious = False
        content = QWidget()
        head = lay_out(QHBoxLayout(), (self.title, 1), self.all_measures)
        self._content = lay_out(QVBoxLayout(content), head, self.plot, self.table, 1, margins=0, spacing=8)
        self.area = scrolled(content, is_upright=False)
        self.setSizePolicy(QSizePolicy.Policy.Expanding, QSizePolicy.Policy.Expanding)
        self.column.addWidget(self.area, 1)
        self.all_measures.toggled.connect(self._show_table)

    def show_comparison(self, found: Comparison, title: str, reported: str) -> None:
        """Show what changed between parts; `reported` are the sentences about it."""
        self._found = found
        groups = comparison_groups(found, is_brief=not self._is_spacious)
        self._say(title, reported)
        self.plot.show_groups(groups, title, reported)
        self._show_table()

    def show_sides(self, rows: Sequence[SideRow], first: Side, second: Side, title: str, reported: str) -> None:
        """Show what the legs differ in."""
        self._found = None
        self._say(title, reported)
        self.plot.show_groups(side_groups(rows, first, is_brief=not self._is_spacious), title, reported)
        self.table.show_rows(*side_table(rows, first, second))

    def set_room(self, is_compact: bool, is_spacious: bool) -> None:
        """Have as many rows and columns as there is room for, from the next time on that something is shown."""
        self._is_compact, self._is_spacious = is_compact, is_spacious

    def begin_with(self, widget: QWidget) -> None:
        """Put a widget over all else, where it scrolls with it."""
        self._content.insertWidget(0, widget)

    def show_parts(self, *, has_plot: bool, has_table: bool, is_alone: bool) -> None:
        """Show the picture, the table or both, in the width that they need, or, alone on the page, in all of it."""
        self.plot.setVisible(has_plot)
        self.table.setVisible(has_table)
        self.all_measures.setVisible(has_table and self._can_be_brief)
        self.fit(is_alone=is_alone)

    def fit(self, *, is_alone: bool) -> None:
        """Leave the curves beside it the larger part."""
        least = LEAST_IF_SPACIOUS if self._is_spacious else LEAST
        shown = [widget for widget in (self.plot, self.table) if not widget.isHidden()]
        needed = max([px(least), *(widget.minimumWidth() + px(2 * PADDING + SCROLL_BAR) for widget in shown)])
        self.setMinimumWidth(0 if is_alone else needed)
        self.setMaximumWidth(WIDEST if is_alone else needed)

    def _say(self, title: str, reported: str) -> None:
        self.title.setText(title)
        self.table.setAccessibleDescription(reported)

    def _show_table(self) -> None:
        if self._found is not None:
            is_brief = self._can_be_brief and not self.all_measures.isChecked()
            most = MOST_VALUES_IF_COMPACT if self._is_compact else MOST_VALUES
            self.table.show_rows(*comparison_table(self._found, most, is_brief=is_brief))

    @property
    def _can_be_brief(self) -> bool:
        found = self._found
        return found is not None and found.kind is Contrast.VISITS and not self._is_spacious and has_brief_table(found)
