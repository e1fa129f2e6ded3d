"""What follows when the live output is set: it is kept, and the card states what came of it."""

from importlib.util import find_spec

from PySide6.QtCore import QObject, Slot

from app.home.settings.live_output_card import LiveOutputCard
from app.live_output.output import live_output
from app.live_output.words import install_words, refusal_words
from app.system.settings import Settings
from app.wording.translation import tr


class LiveOutputControl(QObject):
    """Whoever applies the settings is notified of a change before this one."""

    def __init__(self, settings: Settings, card: LiveOutputCard) -> None:
        super().__init__(card)
        self._settings, self._card = settings, card
        card.lsl.toggled.connect(self._on_lsl_toggled)
        card.websocket.toggled.connect(self._on_websocket_toggled)
        card.port_entered.connect(self._on_port_entered)
        settings.changed.connect(self.show)
        self.show()

    @Slot()
    def show(self) -> None:
        """Show what is kept, and what is so."""
        kept, output = self._settings, live_output
        self._card.show_live(has_lsl=kept.has_live_lsl, has_websocket=kept.has_live_websocket, port=kept.live_port)
        may_lsl, may_websocket = find_spec("pylsl") is not None, find_spec("websockets") is not None
        lsl = "" if may_lsl else install_words("lsl")
        websocket = "" if may_websocket else install_words("live")
        if problem := output.trouble.get("lsl"):
            lsl = refusal_words(problem, kept.live_port)
        elif output.has_lsl:
            lsl = tr("On. Streams appear when the walking page is open.")
        if problem := output.trouble.get("websocket"):
            websocket = refusal_words(problem, kept.live_port)
        elif output.port:
            websocket = tr("On at {address}.").format(address=f"ws://127.0.0.1:{output.port}")
        # what is on can be switched off even where its library has gone
        may_lsl, may_websocket = may_lsl or kept.has_live_lsl, may_websocket or kept.has_live_websocket
        self._card.show_states(lsl, websocket, may_lsl=may_lsl, may_websocket=may_websocket)

    @Slot(bool)
    def _on_lsl_toggled(self, is_on: bool) -> None:
        self._settings.has_live_lsl = is_on

    @Slot(bool)
    def _on_websocket_toggled(self, is_on: bool) -> None:
        self._settings.has_live_websocket = is_on

    @Slot(int)
    def _on_port_entered(self, port: int) -> None:
        self._settings.live_port = port
