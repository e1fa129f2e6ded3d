"""In which language does Qt speak where it opens a dialog of its own: a file's, a printer's?"""

from PySide6.QtCore import QCoreApplication, QLibraryInfo, QTranslator


class QtWords:
    """While it is entered, Qt speaks `language`; where Qt knows none of it, English."""

    def __init__(self, language: str) -> None:
        self._translator = QTranslator()
        folder = QLibraryInfo.path(QLibraryInfo.LibraryPath.TranslationsPath)
        self._is_known = self._translator.load(f"qtbase_{language}", folder)

    def __enter__(self) -> "QtWords":
        if self._is_known:
            QCoreApplication.installTranslator(self._translator)
        return self

    def __exit__(self, *_: object) -> None:
        if self._is_known:
            QCoreApplication.removeTranslator(self._translator)
