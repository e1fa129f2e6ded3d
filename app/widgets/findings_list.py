"""What was noticed, in words, the gravest first; how grave it is shows in the shape beside it."""

from collections.abc import Sequence

from PySide6.QtCore import QSize, Qt
from PySide6.QtGui import QAccessible
from PySide6.QtWidgets import QFrame, QHBoxLayout, QScrollArea, QVBoxLayout, QWidget

from app.theme.current import px, scaled
from app.theme.icons import SEVERITY_ICONS, Icon
from app.widgets.icons import IconMark
from app.widgets.lay_out import lay_out
from app.widgets.text import SEMIBOLD, Text
from app.wording.findings import sentence
from app.wording.translation import later, tr
from core.findings import Finding, Severity

ORDER = (Severity.GRAVE, Severity.WARNING, Severity.INFO)
LEAST_SIZE = (320, 96)  # the rest is scrolled
SEVERITY_WORDS = {
    Severity.GRAVE: later("serious"),
    Severity.WARNING: later("warning"),
    Severity.INFO: later("info"),
}
NOTHING = later("No data quality findings.")
USUAL = frozenset({"not_a_hinge"})  # of living joints: a figure of theirs, which summary.json has


class FindingsList(QScrollArea):
    accessible_role = QAccessible.Role.List

    def __init__(self) -> None:
        super().__init__()
        self.setWidgetResizable(True)
        self.setFrameShape(QFrame.Shape.NoFrame)
        self.setFocusPolicy(Qt.FocusPolicy.StrongFocus)  # so that the keys can scroll it
        self.setHorizontalScrollBarPolicy(Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.setAccessibleName(tr("Findings"))
        scaled(self.setMinimumSize, *LEAST_SIZE)

    def show_findings(self, findings: Sequence[Finding]) -> None:
        findings = [one for one in findings if one.key not in USUAL]
        page = QWidget()
        column = QVBoxLayout(page)
        column.setContentsMargins(0, 0, px(8), 0)
        column.setSpacing(px(12))
        for finding in sorted(findings, key=lambda finding: ORDER.index(finding.severity)):
            column.addWidget(FindingRow(SEVERITY_ICONS[finding.severity], finding.severity, sentence(finding)))
        if not findings:
            column.addWidget(FindingRow(Icon.CHECK, Severity.INFO, tr(NOTHING)))
        column.addStretch(1)
        self.setWidget(page)
        page.setAutoFillBackground(False)  # which a scroll area turns on: the card behind it has the colour
        self.viewport().setAutoFillBackground(False)
        self.setAccessibleDescription(" ".join(sentence(finding) for finding in findings) or tr(NOTHING))

    def sizeHint(self) -> QSize:
        return self.minimumSize()


class FindingRow(QWidget):
    """What happened in bold, what follows below it."""

    accessible_role = QAccessible.Role.ListItem

    def __init__(self, icon: Icon, severity: Severity, text: str) -> None:
        super().__init__()
        what, then = _in_two(text)
        self.setAccessibleName(f"{tr(SEVERITY_WORDS[severity])}: {text}")
        row = QHBoxLayout(self)
        scaled(row.setSpacing, 12)
        lay_out(row, (IconMark(icon), 0, Qt.AlignmentFlag.AlignTop), margins=0)
        words = lay_out(QVBoxLayout(), Text(what, weight=SEMIBOLD, wraps=True), spacing=0)
        if then:
            words.addWidget(Text(then, tone="ink2", wraps=True))
        row.addLayout(words, 1)


def _in_two(text: str) -> tuple[str, str]:
    """Split after the first sentence; a point inside a figure ends none."""
    what, stop, then = text.partition(". ")
    return (what + ".", then) if stop else (text, "")
