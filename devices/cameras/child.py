"""The process that opens a camera: what it decodes can end no more than this process.

The last argument states the camera and its mode in JSON, or of which kind all cameras are to be listed. It writes
`messages` until its standard input is closed, which whoever started it does at the latest by ending.
"""

import json
import os
import signal
import sys
import threading
from dataclasses import asdict

from devices.cameras.camera import CameraInfo, CameraMode
from devices.cameras.causes import CRASHED, MISSING
from devices.cameras.messages import CAMERAS, ENDED, send_details
from devices.files.limits import limit_resources
from devices.files.system_calls import refuse_system_calls

WORD = "take-camera-frames"  # the argument of a frozen program that is started as this process
LIST, CAMERA, MODE_ASKED = "list", "camera", "mode"
MEMORY_BYTES = 4 * 1024**3


def main() -> None:
    """Do what the last argument states."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl C reaches all of a terminal; who asks ends this process
    asked = json.loads(sys.argv[-1])
    stream, closing = os.fdopen(os.dup(1), "wb"), os.fdopen(os.dup(0), "rb")
    nowhere = os.open(os.devnull, os.O_RDWR)
    for number in (0, 1, 2):  # what a library prints is no frame
        os.dup2(nowhere, number)
    limit_resources(MEMORY_BYTES)
    if sys.platform == "linux":  # macOS and Windows reach a camera by other processes
        refuse_system_calls()
    try:
        from devices.cameras import taking  # limited, before it imports what decodes
    except ImportError as problem:
        send_details(stream, ENDED, {"cause": MISSING, "detail": str(problem)})
        return
    if LIST in asked:
        send_details(stream, CAMERAS, [asdict(one) for one in taking.listed_cameras(asked[LIST])])
        return
    one = taking.FrameTaking(CameraInfo(**asked[CAMERA]), CameraMode(**asked[MODE_ASKED]), stream)

    def wait_for_the_end() -> None:
        closing.read()
        one.stop()
        os._exit(0)  # the other thread may wait for a reader that is gone

    threading.Thread(target=wait_for_the_end, daemon=True).start()
    try:
        one.run()
    except BrokenPipeError:
        os._exit(0)
    except Exception as error:  # the edge of the process
        send_details(stream, ENDED, {"cause": CRASHED, "detail": f"{type(error).__name__}: {error}"})
    os._exit(0)  # a thread inside of FFmpeg would keep it


if __name__ == "__main__":
    main()
