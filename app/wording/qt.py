"""Language of Qt where it opens a dialog of its own, such as a file's or a printer's."""

from collections.abc import Iterator
from contextlib import contextmanager

from PySide6.QtCore import QCoreApplication, QLibraryInfo, QTranslator


@contextmanager
def qt_speaks(language: str) -> Iterator[None]:
    """Let Qt speak `language` meanwhile; where Qt knows none of it, English."""
    translator = QTranslator()
    if translator.load(f"qtbase_{language}", QLibraryInfo.path(QLibraryInfo.LibraryPath.TranslationsPath)):
        QCoreApplication.installTranslator(translator)
    yield
    QCoreApplication.removeTranslator(translator)
