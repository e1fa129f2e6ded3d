"""Dialogs that ask which folder or files are meant: the system's own, which hold up nothing meanwhile."""

import os
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

from PySide6.QtCore import QSettings, Qt
from PySide6.QtWidgets import QFileDialog, QWidget

VISITED = ("FileDialog/history", "FileDialog/lastVisited")  # as Qt has them, for all programs of the user


def keep_no_visited_folders() -> None:
    """Keep Qt from storing visited folders, whose names may hold patient codes; call at start and at exit."""
    if sys.platform in ("win32", "darwin"):
        own = QSettings(QSettings.Scope.UserScope, "QtProject")
        for name in VISITED:
            own.remove(name)
    else:
        QSettings.setPath(QSettings.Format.NativeFormat, QSettings.Scope.UserScope, os.devnull)


def ask_for_folder(parent: QWidget, title: str, on_chosen: Callable[[str], None]) -> QFileDialog:
    """Open a dialog for one folder that is there; once it is closed it deletes itself."""
    dialog = QFileDialog(parent, title)
    dialog.setFileMode(QFileDialog.FileMode.Directory)
    dialog.setOption(QFileDialog.Option.ShowDirsOnly)
    dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    dialog.fileSelected.connect(on_chosen)
    dialog.open()
    return dialog


def ask_for_files(parent: QWidget, title: str, on_chosen: Callable[[list[str]], None]) -> QFileDialog:
    """Open a dialog for files that are there; once it is closed it deletes itself."""
    dialog = QFileDialog(parent, title)
    dialog.setFileMode(QFileDialog.FileMode.ExistingFiles)
    dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    dialog.filesSelected.connect(on_chosen)
    dialog.open()
    return dialog


def ask_for_new_folder(
    parent: QWidget, title: str, proposed_in: Callable[[Path], str], on_chosen: Callable[[str], None]
) -> QFileDialog:
    """Open a dialog for a folder that is to be made; `proposed_in` gives its name in the place that is shown first."""
    dialog = QFileDialog(parent, title)
    dialog.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
    dialog.setFileMode(QFileDialog.FileMode.AnyFile)
    dialog.selectFile(proposed_in(Path(dialog.directory().absolutePath())))
    dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    dialog.fileSelected.connect(on_chosen)
    dialog.open()
    return dialog


def ask_for_new_file(
    parent: QWidget,
    title: str,
    proposed: str | Callable[[Path], str],
    on_chosen: Callable[[str], None],
    filters: Sequence[str] = (),
) -> QFileDialog:
    """Open a save dialog; a name without suffix gets that of `proposed`, which may depend on the first folder."""
    dialog = QFileDialog(parent, title)
    dialog.setAcceptMode(QFileDialog.AcceptMode.AcceptSave)
    if not isinstance(proposed, str):
        proposed = proposed(Path(dialog.directory().absolutePath()))
    dialog.setDefaultSuffix(Path(proposed).suffix[1:])
    if filters:
        dialog.setNameFilters(filters)
    dialog.selectFile(proposed)
    dialog.setAttribute(Qt.WidgetAttribute.WA_DeleteOnClose)
    dialog.fileSelected.connect(on_chosen)
    dialog.open()
    return dialog
