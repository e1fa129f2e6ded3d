"""One topic of the manual to read: its type, tables, pictures and films, and marks where something was found."""

import re

from PySide6.QtCore import QPointF, QRectF, Qt, QTimer, QUrl, Signal
from PySide6.QtGui import (
    QColor,
    QFont,
    QHideEvent,
    QImage,
    QKeyEvent,
    QMouseEvent,
    QPainter,
    QResizeEvent,
    QShowEvent,
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

from app.films.film import Film, duration_s, film_height, paint_frame, paint_stills
from app.help.help_topics import help_file
from app.theme.current import current_theme, on_theme, px
from app.theme.motion import duration_ms
from app.widgets.text import MEDIUM, SEMIBOLD
from app.wording.translation import tr

PICTURE = re.compile(r"!\[[^\]]*\]\(([^)]+)\)")
FILM = re.compile(r"films/([\w-]+)\.webp")  # drawn here; a file of that name is on the site only
PAGE = re.compile(r"([\w-]+)\.md")
FRAME_MS = 40
LINE_PERCENT = 145  # of the height of a line: for reading, not for finding
LONGEST_LINE = 760  # some 100 letters; longer lines lose the eye on its way back
TIGHT_LINE_PERCENT = 120  # of headings and tables
HEADING_SIZES = {1: 26, 2: 20, 3: 16}
BODY = 16


class HelpReader(QTextBrowser):
    """The text of a topic in the type of the house, with pictures in the theme that is in force.

    A film plays once when its page is opened; Space or a click on it stops it and plays it again. Where less
    motion is asked for its scenes stand side by side instead.
    """

    page_required = Signal(str)  # the name of another page that a link leads to

    def __init__(self) -> None:
        super().__init__()
        self._markdown = ""
        self._film_name, self._film_s = "", 0.0
        self._beat = QTimer(self)
        self._beat.setInterval(FRAME_MS)
        self._beat.timeout.connect(self._on_beat)
        self._required = ""
        self._marks: list[QTextCursor] = []
        self._at = -1
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setLineWrapMode(QTextEdit.LineWrapMode.FixedPixelWidth)
        self.setOpenLinks(False)  # nothing leads out of this computer
        self.anchorClicked.connect(self._on_link)
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        on_theme(self._apply_theme)

    @property
    def has_marks(self) -> bool:
        return bool(self._marks)

    @property
    def is_playing(self) -> bool:
        """Whether a film moves."""
        return self._beat.isActive()

    def show_markdown(self, markdown: str, name: str) -> None:
        self._markdown = markdown
        self._film_name = next((name for name in PICTURE.findall(markdown) if FILM.fullmatch(name)), "")
        self._film_s = 0.0
        self._set_playing(is_playing=self.isVisible())
        self.setAccessibleName(name)
        self._set_text()
        self.moveCursor(QTextCursor.MoveOperation.Start)
        self.verticalScrollBar().setValue(0)

    def resizeEvent(self, event: QResizeEvent) -> None:
        super().resizeEvent(event)
        if self.lineWrapColumnOrWidth() != self._line_width():
            self._wrap()
            self._set_pictures()

    def showEvent(self, event: QShowEvent) -> None:
        super().showEvent(event)
        self._set_playing(is_playing=True)

    def hideEvent(self, event: QHideEvent) -> None:
        self._set_playing(is_playing=False)
        super().hideEvent(event)

    def keyPressEvent(self, event: QKeyEvent) -> None:
        if event.key() == Qt.Key.Key_Space and self._has_moving_film:
            self._turn()
        else:
            super().keyPressEvent(event)

    def mouseReleaseEvent(self, event: QMouseEvent) -> None:
        picture = self.document().documentLayout().imageAt(self._in_document(event))
        if picture == self._film_name and self._has_moving_film:
            self._turn()
        super().mouseReleaseEvent(event)

    def _in_document(self, event: QMouseEvent) -> QPointF:
        scrolled = QPointF(self.horizontalScrollBar().value(), self.verticalScrollBar().value())
        return event.position() + scrolled

    @property
    def _has_moving_film(self) -> bool:
        return bool(self._film_name) and duration_ms(FRAME_MS, current_theme()) > 0

    def _turn(self) -> None:
        """Stop the film, or play it; from its beginning where it has ended."""
        if not self.is_playing and self._film_s >= duration_s(self._film()):
            self._film_s = 0.0
        self._set_playing(is_playing=not self.is_playing)

    def _set_playing(self, *, is_playing: bool) -> None:
        if is_playing and self._has_moving_film and self._film_s < duration_s(self._film()):
            self._beat.start()
        else:
            self._beat.stop()

    def _film(self) -> Film:
        found = FILM.fullmatch(self._film_name)
        assert found is not None  # asked of pages with a film only
        return Film(found[1])

    def _on_beat(self) -> None:
        self._film_s += FRAME_MS / 1000.0
        if self._film_s >= duration_s(self._film()):
            self._beat.stop()
        kind = QTextDocument.ResourceType.ImageResource.value
        self.document().addResource(
            kind, QUrl(self._film_name), self._film_picture()
        )  # of the same size: no new layout
        self.viewport().update()

    def _on_link(self, url: QUrl) -> None:
        if found := PAGE.fullmatch(url.toString()):
            self.page_required.emit(found[1])

    def _line_width(self) -> int:
        return min(self.viewport().width(), px(LONGEST_LINE))

    def _wrap(self) -> None:
        self.setLineWrapColumnOrWidth(self._line_width())

    def mark(self, required: str) -> None:
        """Mark every place of `required`; none when it is empty."""
        self._required, self._marks, self._at = required, [], -1
        cursor = QTextCursor(self.document())
        while required:
            cursor = self.document().find(required, cursor)
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
        c = current_theme().colours
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
        document.setDocumentMargin(px(8))
        document.setMarkdown(self._markdown, QTextDocument.MarkdownFeature.MarkdownDialectGitHub)
        self._set_pictures()
        whole = QTextCursor(document)
        whole.beginEditBlock()  # else every cell would lay the document out again
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
        if name == self._film_name:
            return self._film_picture()
        path = help_file(name)
        dark = path.with_stem(f"{path.stem}-dark")
        image = QImage(str(dark if current_theme().is_dark and dark.exists() else path))
        ratio = self.devicePixelRatioF()
        width = self._picture_width() * ratio
        scaled = image.scaledToWidth(round(width), Qt.TransformationMode.SmoothTransformation)
        scaled.setDevicePixelRatio(ratio)
        return scaled

    def _picture_width(self) -> float:
        return max(1.0, self._line_width() - 2 * self.document().documentMargin())

    def _film_picture(self) -> QImage:
        """The film as it is now, or its scenes side by side."""
        width, is_moving, ratio = self._picture_width(), self._has_moving_film, self.devicePixelRatioF()
        rect = QRectF(0, 0, width, film_height(width, is_moving=is_moving))
        image = QImage(
            round(rect.width() * ratio), round(rect.height() * ratio), QImage.Format.Format_ARGB32_Premultiplied
        )
        image.setDevicePixelRatio(ratio)
        image.fill(0)  # see-through
        painter = QPainter(image)
        painter.setRenderHint(QPainter.RenderHint.Antialiasing)
        if is_moving:
            paint_frame(
                painter, rect, current_theme(), self._film(), self._film_s, tr("Space bar: pause or play film.")
            )
        else:
            paint_stills(painter, rect, current_theme(), self._film())
        painter.end()
        return image

    def _set_blocks(self) -> None:
        theme, block = current_theme(), self.document().begin()
        cursor = QTextCursor(self.document())
        while block.isValid():
            cursor.setPosition(block.position())
            level, is_in_table = block.blockFormat().headingLevel(), cursor.currentTable() is not None
            form = QTextBlockFormat(block.blockFormat())
            height = LINE_PERCENT if not level and not is_in_table else TIGHT_LINE_PERCENT
            height = 100 if _has_picture(block) else height
            form.setLineHeight(height, QTextBlockFormat.LineHeightTypes.ProportionalHeight.value)
            form.setTopMargin(theme.px(20) if level > 1 else 0)
            form.setBottomMargin(0 if is_in_table else theme.px(4 if block.textList() is not None else 10))
            cursor.setBlockFormat(form)
            self._set_letters(block, theme.font(HEADING_SIZES[level], SEMIBOLD) if level else None)
            block = block.next()

    def _set_letters(self, block: QTextBlock, heading: QFont | None) -> None:
        """Give a heading its size, what is bold the weight that is bundled, and a link its line."""
        pieces, parts = [], block.begin()
        while not parts.atEnd():
            piece = parts.fragment()
            form = piece.charFormat()
            pieces.append((piece.position(), piece.length(), form.fontWeight() > MEDIUM, form.isAnchor()))
            parts += 1
        cursor = QTextCursor(self.document())
        for start, length, is_bold, is_link in pieces:
            if heading is None and not is_bold and not is_link:
                continue
            letters = QTextCharFormat()
            if heading is not None or is_bold:
                letters.setFont(heading or current_theme().font(BODY, SEMIBOLD))
            letters.setFontUnderline(is_link)
            cursor.setPosition(start)
            cursor.setPosition(start + length, QTextCursor.MoveMode.KeepAnchor)
            cursor.mergeCharFormat(letters)

    def _set_tables(self) -> None:
        """Rows under hairlines, as everywhere; no cages."""
        theme = current_theme()
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

    def _apply_theme(self) -> None:
        self.setFont(current_theme().font(BODY))
        at = self.verticalScrollBar().value()
        self._set_playing(is_playing=self.is_playing)  # less motion may be asked for meanwhile
        self._wrap()
        self._set_text()
        self.mark(self._required)
        self.verticalScrollBar().setValue(at)


def _has_picture(block: QTextBlock) -> bool:
    """Whether a picture is in the block, whose line is as high as it."""
    parts = block.begin()
    while not parts.atEnd():
        if parts.fragment().charFormat().isImageFormat():
            return True
        parts += 1
    return False
