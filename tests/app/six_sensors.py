"""Sessions of six sensors and the bytes of their results, which a seventh sensor must not change.

`OPENBLAS_NUM_THREADS=1 python -m tests.app.six_sensors`, as the tests have it, writes tests/golden/six_sensors.json
again, which is to be done on purpose only (last when the foot's angle in swing was added). What a processor writes that
calculates otherwise is put beside: with NPY_DISABLE_CPU_FEATURES=X86_V4,AVX512_ICL,AVX512_SPR and
OPENBLAS_CORETYPE=Haswell a newer one calculates as the older do.
"""

import hashlib
import json
import platform
import tempfile
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from app.exports.result_folder import write_results
from core.body import Side, Site
from core.session import Session
from core.signal.filters import FILTER
from devices.simulation.walker import FreeMotion, Standing, Tissue, Walk, WalkerSettings
from tests.simulated import analysis_of, session_of

GOLDEN = Path(__file__).parents[1] / "golden" / "six_sensors.json"
RIGHT_LATE = dict.fromkeys((Site.RIGHT_THIGH, Site.RIGHT_SHANK, Site.RIGHT_FOOT), 0.04)
SESSIONS = {
    "rigid": WalkerSettings(seed=1, recordings=(Standing(), FreeMotion(), Walk(strides=5))),
    "real, turning, a clock per leg": WalkerSettings(
        seed=2,
        tissue=Tissue.REAL,
        recordings=(Standing(), Walk(strides=7, turn_rad=np.pi)),
        clock_late_s=RIGHT_LATE,
    ),
    "prosthesis, one leg": WalkerSettings(
        seed=3,
        tissue=Tissue.SOFT,
        prosthetic_side=Side.LEFT,
        sites=(Site.LEFT_THIGH, Site.LEFT_SHANK, Site.LEFT_FOOT),
        recordings=(Standing(), FreeMotion(), Walk(strides=5), Walk(name="walk 2", strides=5)),
    ),
}


def vectors() -> str:
    """The widest vectors that NumPy finds in this processor: the last digits of sums and products hang on them, too."""
    found: list[str] = np.show_config(mode="dicts")["SIMD Extensions"]["found"]
    return next((level for level in ("X86_V4", "X86_V3") if level in found), " ".join(found))


def machine() -> dict[str, str]:
    """What the last digits of a result depend on, besides `vectors`."""
    parts = {name: version(name) for name in ("numpy", "scipy", "pyarrow")} | {"vqf": FILTER.removeprefix("vqf ")}
    return {"machine": platform.machine(), "system": platform.system(), **parts}


def written(session: Session) -> dict[str, bytes]:
    """Every file of a session's results by its name."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        write_results(session, analysis_of(session), folder)
        files = sorted(path for path in folder.rglob("*") if path.is_file())
        return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def digests(files: dict[str, bytes]) -> dict[str, str]:
    return {name: hashlib.sha256(content).hexdigest() for name, content in files.items()}


def structure(files: dict[str, bytes]) -> dict[str, Any]:
    """Heading of every table and keys of every JSON file, which no machine changes."""
    found: dict[str, Any] = {}
    for name, content in files.items():
        text = content.decode()
        found[name] = _keys(json.loads(text)) if name.endswith(".json") else text.splitlines()[0]
    return found


def _keys(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _keys(inner) for name, inner in value.items()}
    return None


if __name__ == "__main__":
    before: dict[str, Any] = json.loads(GOLDEN.read_text(encoding="utf-8"))
    kept = before["digests"] if before["machine"] == machine() else {}
    reported: dict[str, Any] = {"machine": machine(), "digests": kept | {vectors(): {}}, "structure": {}}
    for case, settings in SESSIONS.items():
        content = written(session_of(settings))
        reported["digests"][vectors()][case], reported["structure"][case] = digests(content), structure(content)
    GOLDEN.write_text(json.dumps(reported, indent=1) + "\n", encoding="utf-8")
