"""Export an analysis for other programs: CSV for a spreadsheet, Parquet for R or pandas, netCDF with named axes.

    python -m tests.examples.export_tables SESSION FOLDER

FOLDER gets `strides.csv`, `angles.parquet` and one `NAME.nc` for each walk with its mean cycles, and `cycles.png`,
drawn from what was written. Status goes with every figure: whoever reads the files knows what is not reported.
"""

import sys
from pathlib import Path

import xarray
from matplotlib.figure import Figure

from core import RecordingKind, analyse
from devices import read_session


def main(folder: Path, out: Path) -> None:
    out.mkdir(parents=True, exist_ok=True)
    analysis = analyse(read_session(folder))
    analysis.to_dataframe("strides").to_csv(out / "strides.csv", index=False)
    analysis.to_dataframe("angles").to_parquet(out / "angles.parquet")
    figure = Figure(figsize=(8, 4), layout="constrained")
    axes = figure.subplots()
    for one in analysis.recordings:
        if one.kind is RecordingKind.WALKING:
            analysis.to_xarray(one.name, "cycles").to_netcdf(out / f"{one.folder}.nc", engine="scipy")
            with xarray.open_dataset(out / f"{one.folder}.nc", engine="scipy") as written:
                for side in written["side"].to_numpy():
                    knee = written["value"].sel(quantity="knee_deg", side=side)
                    axes.plot(knee["percent"], knee, label=f"{one.name}, {side}")
    axes.set(xlabel="gait cycle (%)", ylabel="knee flexion (deg)")
    axes.legend()
    figure.savefig(out / "cycles.png")
    print(*sorted(path.name for path in out.iterdir()), sep="\n")


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:]))
