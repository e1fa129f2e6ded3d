"""What the rates and what the accelerations of a walk have to say about the relative heading of two filters."""

import numpy as np
from matplotlib.figure import Figure
from site_material import WALK, moving

from core.calibration.coincidence import fit_forces, joint_forces
from core.samples import FloatArray
from core.signal.datasets import Datasets
from core.signal.rotations import turn_about_vertical
from devices.simulation.walker import Tissue

SAMPLES, FLOOR = 400, 0.05


def draw(figure: Figure) -> None:
    data = moving(Tissue.REAL, WALK).thinned(SAMPLES)
    heading = np.deg2rad(np.arange(0.0, 361.0, 5.0))
    forces = joint_forces(data)
    by_forces = fit_forces(forces, np.repeat(heading[:, None], len(forces), axis=1)).cost + FLOOR
    by_rates = np.array([_off_axis(data, one) for one in heading])
    axes = figure.subplots()
    best = heading[int(np.argmin(by_forces * by_rates))]
    from_best_deg = np.rad2deg(np.angle(np.exp(1j * (heading - best))))
    order = np.argsort(from_best_deg)
    for cost, label, line in ((by_rates, "off-axis rate", "-"), (by_forces, "accelerations of the joint", "--")):
        axes.plot(from_best_deg[order], (cost / cost.min())[order], line, label=label)
    axes.set(xlabel="heading from the chosen one (°)", ylabel="cost over its least", xticks=np.arange(-180, 181, 60))
    axes.legend(loc="upper right")
    axes.set_ylim(0.8, 6.5)


def _off_axis(data: Datasets, heading_rad: float) -> float:
    """The energy of the relative rate beside its principal direction, in both sensors."""
    rate_1 = np.einsum("nij,nj->ni", data.earth_from_1, data.g1)
    rate_2 = np.einsum("nij,nj->ni", data.earth_from_2, data.g2)
    relative: FloatArray = turn_about_vertical(np.full(len(data), heading_rad), rate_2) - rate_1
    back = turn_about_vertical(np.full(len(data), -heading_rad), relative)
    seen = (
        np.einsum("nij,ni->nj", data.earth_from_1, relative),
        np.einsum("nij,ni->nj", data.earth_from_2, back),
    )
    return float(sum(np.linalg.eigvalsh(one.T @ one / len(one))[:2].sum() for one in seen))
