"""One topic of the manual to read: its type, its tables, its pictures, and marks where something was found."""

import re

from PySide6.QtCore import QEvent, Qt, QUrl
from PySide6.QtGui import (
    QColor,
    QFont,
    QImage,
    QResizeEvent,
    QTextBlock,
    QTextBlockFormat,
    QTextCharFormat,
    QTextCursor,
    QTextDocument,
    QTextFrameFormat,
    QTextLength,
    QTextTable,
    QTextTableFormat,
)
from PySide6.QtWidgets import QFrame, QTextBrowser, QTextEdit

from app.pages.help_topics import FOLDER
from app.theme import ThemeNotifier
from app.widgets.text import MEDIUM, SEMIBOLD

PICTURE = re.compile(r"!\[[^\]]*\]\(([^)]+)\)")
LINE_PERCENT = 145  # of the height of a line: for reading, not for finding
LONGEST_LINE = 760  # some 100 letters; longer lines lose the eye on its way back
TIGHT_LINE_PERCENT = 120  # of headings and tables
HEADING_SIZES = {1: 26, 2: 20, 3: 16}
BODY = 16


class HelpReader(QTextBrowser):
    """The text of a topic in the type of the house, with pictures in the theme that is in force."""

    def __init__(self, look: ThemeNotifier) -> None:
        super().__init__()
        self._look, self._markdown = look, ""
        self._wanted = ""
        self._marks: list[QTextCursor] = []
        self._at = -1
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setLineWrapMode(QTextEdit.LineWrapMode.FixedPixelWidth)
        self.setOpenLinks(False)  # nothing leads out of this computer
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self._on_look_changed()

    @property
    def has_marks(self) -> bool:
        return bool(self._marks)

    def show_markdown(self, markdown: str, name: str) -> None:
        self._markdown = markdown
        self.setAccessibleName(name)
        self._set_text()
        self.moveCursor(QTextCursor.MoveOperation.Start)
        self.verticalScrollBar().setValue(0)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        if self.lineWrapColumnOrWidth() != self._line_width():
            self._wrap()
            self._set_pictures()

    def _line_width(self) -> int:
        return min(self.viewport().width(), self._look.theme.px(LONGEST_LINE))

    def _wrap(self) -> None:
        self.setLineWrapColumnOrWidth(self._line_width())

    def mark(self, wanted: str) -> None:
        """Mark every place of `wanted`; none when it is empty."""
        self._wanted, self._marks, self._at = wanted, [], -1
        cursor = QTextCursor(self.document())
        while wanted:
            cursor = self.document().find(wanted, cursor)
            if cursor.isNull():
                break
            self._marks.append(QTextCursor(cursor))
        self._show_marks()

    def go_to_next(self) -> bool:
        """Bring the next mark into sight; False where there is none behind the present one."""
        if self._at + 1 >= len(self._marks):
            return False
        self._at += 1
        cursor = QTextCursor(self._marks[self._at])
        cursor.setPosition(cursor.selectionStart())
        self.setTextCursor(cursor)
        self.ensureCursorVisible()
        self._show_marks()
        return True

    def _show_marks(self) -> None:
        """What is found lies on caution's ground; where the reading is, on ink."""
        c = self._look.theme.colours
        selections = []
        for i, cursor in enumerate(self._marks):
            selection = QTextEdit.ExtraSelection()
            selection.cursor = cursor
            ground, ink = (c.inv, c.inv_ink) if i == self._at else (c.caution_mark, c.caution_mark_ink)
            form = QTextCharFormat()
            form.setBackground(QColor(ground))
            form.setForeground(QColor(ink))
            selection.format = form
            selections.append(selection)
        self.setExtraSelections(selections)

    def _set_text(self) -> None:
        document = self.document()
        document.setDocumentMargin(self._look.theme.px(8))
        document.setMarkdown(self._markdown, QTextDocument.MarkdownFeature.MarkdownDialectGitHub)
        self._set_pictures()
        whole = QTextCursor(document)
        whole.beginEditBlock()  # else every cell would lay the document out anew
        self._set_blocks()
        self._set_tables()
        whole.endEditBlock()

    def _set_pictures(self) -> None:
        document = self.document()
        names = PICTURE.findall(self._markdown)
        for name in names:
            document.addResource(QTextDocument.ResourceType.ImageResource.value, QUrl(name), self._picture(name))
        if names:
            document.markContentsDirty(0, document.characterCount())

    def _picture(self, name: str) -> QImage:
        """As wide as the lines; the dark one, where there is one, in the dark theme."""
        path = FOLDER / name
        dark = path.with_stem(f"{path.stem}-dark")
        image = QImage(str(dark if self._look.theme.is_dark and dark.exists() else path))
        ratio = self.devicePixelRatioF()
        width = max(1.0, (self._line_width() - 2 * self.document().documentMargin()) * ratio)
        scaled = image.scaledToWidth(round(width), Qt.TransformationMode.SmoothTransformation)
        scaled.setDevicePixelRatio(ratio)
        return scaled

    def _set_blocks(self) -> None:
        theme, block = self._look.theme, self.document().begin()
        cursor = QTextCursor(self.document())
        while block.isValid():
            cursor.setPosition(block.position())
            level, is_in_table = block.blockFormat().headingLevel(), cursor.currentTable() is not None
            form = QTextBlockFormat(block.blockFormat())
            height = LINE_PERCENT if not level and not is_in_table else TIGHT_LINE_PERCENT
            form.setLineHeight(height, QTextBlockFormat.LineHeightTypes.ProportionalHeight.value)
            form.setTopMargin(theme.px(20) if level > 1 else 0)
            form.setBottomMargin(0 if is_in_table else theme.px(4 if block.textList() is not None else 10))
            cursor.setBlockFormat(form)
            self._set_letters(block, theme.font(HEADING_SIZES[level], SEMIBOLD) if level else None)
            block = block.next()

    def _set_letters(self, block: QTextBlock, heading: QFont | None) -> None:
        """Give a heading its size, and what is bold the weight that is bundled."""
        pieces, parts = [], block.begin()
        while not parts.atEnd():
            piece = parts.fragment()
            pieces.append((piece.position(), piece.length(), piece.charFormat().fontWeight()))
            parts += 1
        cursor = QTextCursor(self.document())
        for start, length, weight in pieces:
            if heading is None and weight <= MEDIUM:
                continue
            letters = QTextCharFormat()
            letters.setFont(heading or self._look.theme.font(BODY, SEMIBOLD))
            cursor.setPosition(start)
            cursor.setPosition(start + length, QTextCursor.MoveMode.KeepAnchor)
            cursor.mergeCharFormat(letters)

    def _set_tables(self) -> None:
        """Rows under hairlines, as everywhere; no cages."""
        theme = self._look.theme
        for frame in self.document().rootFrame().childFrames():
            if not isinstance(frame, QTextTable):
                continue
            form = QTextTableFormat(frame.format())
            form.setBorder(0)
            form.setBorderCollapse(True)
            form.setCellPadding(theme.px(8))
            form.setCellSpacing(0)
            form.setWidth(QTextLength(QTextLength.Type.PercentageLength, 100))
            form.setTopMargin(theme.px(4))
            form.setBottomMargin(theme.px(12))
            frame.setFormat(form)
            for row in range(frame.rows()):
                for column in range(frame.columns()):
                    cell = frame.cellAt(row, column)
                    under = cell.format().toTableCellFormat()
                    under.setBottomBorder(1)
                    under.setBottomBorderStyle(QTextFrameFormat.BorderStyle.BorderStyle_Solid)
                    under.setBottomBorderBrush(QColor(theme.colours.line))
                    cell.setFormat(under)

    def changeEvent(self, event: QEvent) -> None:
        super().changeEvent(event)
        if event.type() is QEvent.Type.StyleChange:
            self._on_look_changed()

    def _on_look_changed(self) -> None:
        self.setFont(self._look.theme.font(BODY))
        at = self.verticalScrollBar().value()
        self._wrap()
        self._set_text()
        self.mark(self._wanted)
        self.verticalScrollBar().setValue(at)
