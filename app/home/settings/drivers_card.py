"""Drivers of other packages, in the settings: which are installed, and whether they may run here."""

from collections.abc import Sequence

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QHBoxLayout, QVBoxLayout, QWidget

from app.home.settings.settings_card import SettingsCard
from app.system.allowed_drivers import DriverPackage
from app.theme.current import scaled
from app.widgets.lay_out import lay_out
from app.widgets.text import Text
from app.widgets.toggle import Toggle
from app.wording.translation import tr


class DriversCard(SettingsCard):
    """Hidden where no installed package brings a driver."""

    allowed = Signal(str, str, bool)  # package, version, whether it may run

    def __init__(self) -> None:
        super().__init__(tr("Drivers of other packages"))
        hint = tr(
            "These packages add sensors. Their drivers run as part of this program and can read everything "
            "that it can read. Allow a package only if you trust its authors. A new version has to be "
            "allowed again."
        )
        self.fill(Text(hint, tone="ink2", wraps=True))
        self._rows = QVBoxLayout()
        self.column.addLayout(self._rows)
        scaled(self._rows.setSpacing, 8)
        self.hide()

    @property
    def toggles(self) -> list[QWidget]:
        found = (self._rows.itemAt(k) for k in range(self._rows.count()))
        rows = (item.widget() for item in found if item is not None)
        return [row.toggle for row in rows if isinstance(row, _PackageRow)]

    def show_packages(self, packages: Sequence[DriverPackage]) -> None:
        """Show what is installed and what of it is allowed."""
        while (item := self._rows.takeAt(0)) is not None:
            if (widget := item.widget()) is not None:
                widget.hide()
                widget.deleteLater()
        for package in packages:
            row = _PackageRow(package)
            row.allowed.connect(self.allowed)
            self._rows.addWidget(row)
        self.setVisible(bool(packages))


class _PackageRow(QWidget):
    allowed = Signal(str, str, bool)

    def __init__(self, package: DriverPackage) -> None:
        super().__init__()
        self._package = package
        name = tr("{package}, version {version}").format(package=package.name, version=package.version)
        drivers = tr("Drivers: {names}").format(names=", ".join(package.drivers))
        words = lay_out(
            QVBoxLayout(), Text(name, size=15, wraps=True), Text(drivers, size=14, tone="ink2", wraps=True), spacing=0
        )
        self.toggle = Toggle(tr("Allow"), "", is_on=package.is_allowed)
        self.toggle.setAccessibleName(f"{self.toggle.text()}, {name}")
        self.toggle.toggled.connect(self._on_toggled)
        lay_out(QHBoxLayout(self), (words, 1), self.toggle, margins=0)

    def _on_toggled(self, is_allowed: bool) -> None:
        self.allowed.emit(self._package.name, self._package.version, is_allowed)
