"""Make a session of arrays of your own, by stating at which site each sensor was worn, and analyse it.

    python -m tests.examples.own_sensor_positions SAMPLES.npz FIGURE.png

SAMPLES.npz holds one array per sensor (n, 7): seconds, angular rate in rad/s, specific force in m/s2, all sensors by
one clock. Any set of sites that forms a joint will do. A walk alone identifies its joints, and has no standing: the
shape of the curve holds, its zero does not.
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from core import ImuBlock, Recording, RecordingKind, SensorInfo, Session, Site, analyse

POSITIONS = {"A": Site.LEFT_THIGH, "B": Site.LEFT_SHANK, "C": Site.LEFT_FOOT}


def main(samples: Path, out: Path) -> None:
    with np.load(samples) as file:
        blocks = {
            site: ImuBlock(name, file[name][:, 0], file[name][:, 1:4], file[name][:, 4:7])
            for name, site in POSITIONS.items()
        }
    walk = Recording("walk 1", RecordingKind.WALKING, "walk_1", blocks)
    sensors = {site: SensorInfo(serial=name, clock="one") for name, site in POSITIONS.items()}
    frame = analyse(Session((walk,), sensors=sensors)).to_dataframe("cycles")
    shapes = frame[frame["quantity"].str.endswith("_shape_deg")]
    print(shapes.groupby("quantity")[["status", "n"]].first().to_string())
    figure = Figure(figsize=(6, 3.5), layout="constrained")
    axes = figure.subplots()
    for quantity, rows in shapes.groupby("quantity"):
        axes.plot(rows["percent"], rows["value"], label=quantity)
    axes.set(xlabel="gait cycle (%)", ylabel="angle less its mean (deg)")
    axes.legend()
    figure.savefig(out)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
