"""Ask qmt, in the peers' own environment, for the axes of a joint."""

import json
import subprocess
import tempfile
from pathlib import Path
from types import TracebackType

import numpy as np

from core.samples import FloatArray
from tests.benchmarks.peers.environment import peers_python
from tests.benchmarks.trials import Trial


class QmtAxes:
    """A running worker. It works while we wait, so the two never compete for a core."""

    def __init__(self) -> None:
        self._folder = tempfile.TemporaryDirectory()
        worker = [str(peers_python()), str(Path(__file__).with_name("qmt_worker.py"))]
        self._process = subprocess.Popen(worker, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def __enter__(self) -> "QmtAxes":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._process.communicate()
        self._folder.cleanup()

    def find(self, trial: Trial) -> tuple[FloatArray, FloatArray, float]:
        """Both axes (3,) and the CPU seconds they took."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        path = Path(self._folder.name) / "trial.npz"
        np.savez(path, acc1=trial.a1, acc2=trial.a2, gyr1=trial.g1, gyr2=trial.g2)
        self._process.stdin.write(f"{path}\n")
        self._process.stdin.flush()
        answer = self._process.stdout.readline()
        if not answer:
            raise RuntimeError("qmt's worker ended; what it said stands above")
        found = json.loads(answer)
        return np.array(found["axis_1"]), np.array(found["axis_2"]), float(found["cpu_s"])
