"""Analyse a session and take its angles as a tidy table.

    python -m tests.examples.angles_as_a_frame SESSION FIGURE.png

A row is one sample of one quantity, with its standard deviation and its status. "withheld" is not reported and has to
be left out by whoever computes with it; "no_zero" has a shape and no absolute angle. Printed is how many samples have
which status; the figure shows the reported knee angles of the last walk with their standard deviation.
"""

import sys
from pathlib import Path

from matplotlib.figure import Figure

from core import analyse
from devices import read_session


def main(folder: Path, out: Path) -> None:
    frame = analyse(read_session(folder)).to_dataframe("angles")
    print(frame[frame["value"].notna()].value_counts(["recording", "quantity", "status"]).sort_index().to_string())
    knees = frame[(frame["quantity"] == "knee_deg") & frame["status"].isin(["read", "care"])]
    figure = Figure(figsize=(8, 3.5), layout="constrained")
    axes = figure.subplots()
    for side, rows in knees[knees["recording"] == knees["recording"].iloc[-1]].groupby("side"):
        axes.plot(rows["time_s"], rows["value"], label=side)
        axes.fill_between(rows["time_s"], rows["value"] - rows["sd"], rows["value"] + rows["sd"], alpha=0.3)
    axes.set(xlabel="time (s)", ylabel="knee flexion (deg)")
    axes.legend()
    figure.savefig(out)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
