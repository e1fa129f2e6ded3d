"""The card of the settings about the live output: what other programs on this computer receive of the running walk."""

from PySide6.QtCore import Signal
from PySide6.QtWidgets import QWidget

from app.home.settings.settings_card import SettingsCard
from app.widgets.field import Field
from app.widgets.text import MEDIUM, Text
from app.widgets.toggle import Toggle
from app.wording.translation import tr

LOWEST_PORT, HIGHEST_PORT = 1024, 65535


class LiveOutputCard(SettingsCard):
    port_entered = Signal(int)

    def __init__(self) -> None:
        super().__init__(tr("Live output for other programs"))
        hint = tr(
            "While a walk is recorded, programs on this computer can receive joint angles, their errors and gait "
            "events. Names, codes and conditions are not sent."
        )
        lsl_hint = tr(
            "Lab Streaming Layer adds this computer's name to its streams. Other computers in the network can reach "
            "its ports. Use it only behind a firewall."
        )
        self.lsl = Toggle(tr("Lab Streaming Layer"), "", is_on=False)
        self.lsl_stated = Text(weight=MEDIUM, wraps=True)
        self.websocket = Toggle(tr("WebSocket"), "", is_on=False)
        self.port = Field(tr("Port of the WebSocket"), most=5)
        self.websocket_stated = Text(weight=MEDIUM, wraps=True)
        self.fill(Text(hint, tone="ink2", wraps=True))
        self.add_left(self.lsl)
        self.fill(Text(lsl_hint, tone="ink2", wraps=True), self.lsl_stated)
        self.add_left(self.websocket)
        self.fill(self.port, self.websocket_stated)
        self.port.committed.connect(self._on_port_committed)

    @property
    def tab_order(self) -> list[QWidget]:
        return [self.lsl, self.websocket, self.port.line_edit]

    def show_live(self, *, has_lsl: bool, has_websocket: bool, port: int) -> None:
        """Show what is switched on."""
        self.lsl.show_on(has_lsl)
        self.websocket.show_on(has_websocket)
        self.port.set_text(str(port))
        self.port.set_wrong("")

    def show_states(self, lsl: str, websocket: str, *, may_lsl: bool, may_websocket: bool) -> None:
        """Say of each how it is; `may_`: whether it can be switched."""
        self.lsl_stated.setText(lsl)
        self.lsl_stated.setVisible(bool(lsl))
        self.websocket_stated.setText(websocket)
        self.websocket_stated.setVisible(bool(websocket))
        self.lsl.setEnabled(may_lsl)
        self.websocket.setEnabled(may_websocket)
        self.port.setEnabled(may_websocket)

    def _on_port_committed(self) -> None:
        text = self.port.text.strip()
        port = int(text) if text.isascii() and text.isdigit() else 0
        if LOWEST_PORT <= port <= HIGHEST_PORT:
            self.port.set_wrong("")
            self.port_entered.emit(port)
        else:
            self.port.set_wrong(
                tr("Enter a number from {lowest} to {highest}.").format(lowest=LOWEST_PORT, highest=HIGHEST_PORT)
            )
