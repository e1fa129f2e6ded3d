"""What Qt warns of, in the log."""

import logging
import sys

from PySide6.QtCore import QMessageLogContext, QtMsgType, qInstallMessageHandler

_log = logging.getLogger(__name__)


def log_qt_messages() -> None:
    """Note that Qt warned, and how gravely; its words may hold a path, so they go to the terminal only."""
    levels = {
        QtMsgType.QtWarningMsg: logging.WARNING,
        QtMsgType.QtCriticalMsg: logging.ERROR,
        QtMsgType.QtFatalMsg: logging.CRITICAL,
    }

    def note(kind: QtMsgType, _context: QMessageLogContext, message: str) -> None:
        level = levels.get(kind, logging.DEBUG)
        _log.log(level, "Qt has something to say")
        if level >= logging.WARNING and sys.stderr is not None:
            print(message, file=sys.stderr)

    qInstallMessageHandler(note)
