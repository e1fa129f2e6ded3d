"""Settings of what a user of this computer wants to see and hear.

They are kept for the next start and hold nothing about patients.
"""

from enum import StrEnum

from PySide6.QtCore import QObject, QSettings, Signal

from app.wording.translation import languages

FROM, TO = 0.8, 2.0
LIVE_PORT = 8765  # as good as any: nothing is registered for it that a clinic would run


class Scheme(StrEnum):
    SYSTEM = "system"
    LIGHT = "light"
    DARK = "dark"


class Settings(QObject):
    """Typed access; whatever a damaged file holds counts as not set."""

    changed = Signal()
    language_changed = Signal()

    def __init__(self, kept: QSettings, parent: QObject | None = None) -> None:
        super().__init__(parent)
        self._kept = kept

    @property
    def scheme(self) -> Scheme:
        try:
            return Scheme(str(self._kept.value("scheme", "")))
        except ValueError:
            return Scheme.SYSTEM

    @scheme.setter
    def scheme(self, scheme: Scheme) -> None:
        self._put("scheme", scheme.value)

    @property
    def scale(self) -> float:
        """The size of everything."""
        try:
            return min(max(float(str(self._kept.value("scale", "1"))), FROM), TO)
        except ValueError:
            return 1.0

    @scale.setter
    def scale(self, scale: float) -> None:
        self._put("scale", str(scale))

    @property
    def language(self) -> str:
        """What is spoken on the screen, as "de"."""
        language = str(self._kept.value("language", ""))
        return language if language in languages() else "en"

    @language.setter
    def language(self, language: str) -> None:
        if language != self.language:
            self._put("language", language)
            self.language_changed.emit()

    @property
    def is_from_behind(self) -> bool:
        """Whether figures show the patient from behind."""
        return self._kept.value("is_from_behind", "") == "yes"

    @is_from_behind.setter
    def is_from_behind(self, is_from_behind: bool) -> None:
        self._put("is_from_behind", "yes" if is_from_behind else "no")

    @property
    def has_sound(self) -> bool:
        return self._kept.value("has_sound", "") != "no"

    @has_sound.setter
    def has_sound(self, has_sound: bool) -> None:
        self._put("has_sound", "yes" if has_sound else "no")

    @property
    def has_prompts(self) -> bool:
        """Whether what is to be done is spoken."""
        return self._kept.value("has_prompts", "") == "yes"

    @has_prompts.setter
    def has_prompts(self, has_prompts: bool) -> None:
        self._put("has_prompts", "yes" if has_prompts else "no")

    @property
    def has_less_motion(self) -> bool:
        """Whether nothing may move by itself; else that is as the system was asked for."""
        return self._kept.value("has_less_motion", "") == "yes"

    @has_less_motion.setter
    def has_less_motion(self, has_less_motion: bool) -> None:
        self._put("has_less_motion", "yes" if has_less_motion else "no")

    @property
    def has_live_lsl(self) -> bool:
        """Whether the running walk is sent through Lab Streaming Layer."""
        return self._kept.value("has_live_lsl", "") == "yes"

    @has_live_lsl.setter
    def has_live_lsl(self, has_live_lsl: bool) -> None:
        self._put("has_live_lsl", "yes" if has_live_lsl else "no")

    @property
    def has_live_websocket(self) -> bool:
        """Whether the running walk is sent over a WebSocket."""
        return self._kept.value("has_live_websocket", "") == "yes"

    @has_live_websocket.setter
    def has_live_websocket(self, has_live_websocket: bool) -> None:
        self._put("has_live_websocket", "yes" if has_live_websocket else "no")

    @property
    def live_port(self) -> int:
        """The port of that WebSocket."""
        kept = str(self._kept.value("live_port", ""))
        return int(kept) if kept.isascii() and kept.isdigit() and 0 < int(kept[:6]) <= 65535 else LIVE_PORT

    @live_port.setter
    def live_port(self, port: int) -> None:
        self._put("live_port", str(port))

    @property
    def latest_operator(self) -> str:
        """The code of whoever logged in last here."""
        return str(self._kept.value("latest_operator", ""))

    @latest_operator.setter
    def latest_operator(self, code: str) -> None:
        self._put("latest_operator", code)

    @property
    def latest_library(self) -> str:
        """The folder of the library that was opened last; where it is not there any more, it is missing."""
        return str(self._kept.value("latest_library", ""))

    @latest_library.setter
    def latest_library(self, folder: str) -> None:
        self._put("latest_library", folder)

    @property
    def latest_source(self) -> str:
        """The key of the source whose sensors were received last here."""
        return str(self._kept.value("latest_source", ""))

    @latest_source.setter
    def latest_source(self, key: str) -> None:
        self._put("latest_source", key)

    @property
    def latest_table(self) -> str:
        """The table of a batch that was asked last; where it is not there any more, it is missing."""
        return str(self._kept.value("latest_table", ""))

    @latest_table.setter
    def latest_table(self, path: str) -> None:
        self._put("latest_table", path)

    def _put(self, name: str, value: str) -> None:
        if self._kept.value(name, None) != value:
            self._kept.setValue(name, value)
            self.changed.emit()
