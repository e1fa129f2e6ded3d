"""The processes that this program starts of itself, by the word that a frozen program is started with."""

from devices.cameras import child as camera
from devices.files import child as files

CHILDREN = {files.WORD: files, camera.WORD: camera}
