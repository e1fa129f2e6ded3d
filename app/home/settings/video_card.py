"""The card of the settings about videos: how long they are kept, and whether backups hold them."""

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QWidget

from app.home.settings.settings_card import SettingsCard
from app.widgets.segmented import Segmented
from app.widgets.text import MEDIUM, Text
from app.widgets.toggle import Toggle
from app.wording.translation import tr


class VideoCard(SettingsCard):
    days_chosen = Signal(int)  # 0: as long as their session

    def __init__(self) -> None:
        super().__init__(tr("Videos of walks"))
        hint = tr(
            "Videos show faces. They can be kept for less time than measurements. Older videos are destroyed when "
            "Gaitwright starts. The measurements stay."
        )
        lines = [("90", tr("90 days"), ""), ("365", tr("1 year"), ""), ("0", tr("As long as the session"), "")]
        self.days = Segmented(tr("Keep videos"), lines)
        self.in_backups = Toggle(tr("Include videos in backups"), "", is_on=False)
        self.fill(Text(hint, tone="ink2", wraps=True), Text(tr("Keep videos"), weight=MEDIUM))
        self.add_left(self.days)
        self.add_left(self.in_backups)
        self.days.chosen.connect(lambda key: self.days_chosen.emit(int(key)))

    @property
    def tab_order(self) -> list[QWidget]:
        return [*self.days.segments, self.in_backups]

    def show_settings(self, days: int, *, is_in_backups: bool) -> None:
        """Show what is set in the library; of other days, which no choice here sets, the longer."""
        offered = [one for one in (90, 365) if days and days <= one]
        self.days.choose(str(offered[0] if offered else 0))
        self.in_backups.show_on(is_in_backups)
