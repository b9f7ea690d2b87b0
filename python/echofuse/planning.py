"""What a site covers before anybody builds it (sensor-radar paper, section III)."""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from echofuse import _core
from echofuse.constants import SPEED_OF_LIGHT_MPS
from echofuse.errors import InputError, problem
from echofuse.pipeline import hub_config
from echofuse.site import PIPELINES, Site, apply_settings
from echofuse.site.stages import PlanConfig

GRID_STEPS = 160  # along the longer side


@dataclass(frozen=True, kw_only=True)
class Plan:
    """Maps over a grid; arrays (n_y, n_x), those of the pairs (n_pairs, n_y, n_x)."""

    site: Site
    x_m: NDArray[np.float64]
    y_m: NDArray[np.float64]
    position_error_bound_m: NDArray[np.float64]  # infinite where too few pairs cover
    n_covering_pairs: NDArray[np.int64]
    blind: NDArray[np.bool_]  # of each pair
    snr_db: NDArray[np.float64]  # of each pair
    metrics: dict[str, float]

    def figure_data(self) -> dict[str, Any]:
        """Return the arguments of `display.plan_figure.plan_figure`."""
        return {
            "x_m": self.x_m,
            "y_m": self.y_m,
            "position_error_bound_m": self.position_error_bound_m,
            "n_covering_pairs": self.n_covering_pairs,
            "blind": self.blind,
            "snr_db": self.snr_db,
            "tx_position_m": np.array([node.tx_position_m for node in self.site.nodes]),
            "rx_position_m": np.array([node.rx_position_m for node in self.site.nodes]),
            "names": [node.name for node in self.site.nodes],
            "site_name": self.site.name,
        }


def plan_site(site: Site) -> Plan:
    """Return coverage and attainable accuracy all over the site's area; not of a site behind a wall."""
    if PIPELINES[site.pipeline].behind_wall:
        expected = "sensor_radar: a plan knows the paths of free space alone"
        raise InputError(problem(site.name, "pipeline.name", expected, site.pipeline))
    config = PlanConfig()
    apply_settings(config, site.settings)
    budget = config.coverage
    coverage, geometry = _core.Coverage(), hub_config(site)
    if coverage.configure(budget, geometry.nodes[: geometry.n_nodes], geometry.area) != _core.Status.ok:
        raise InputError(problem(site.name, "pipeline.coverage", "a link budget and a site that can work"))
    x_min, y_min, x_max, y_max = site.bounds_m
    step_m = max(x_max - x_min, y_max - y_min) / GRID_STEPS
    x_m, y_m = (_centres(low, high, step_m) for low, high in ((x_min, x_max), (y_min, y_max)))
    grid = np.stack(np.meshgrid(x_m, y_m), axis=-1)  # (n_y, n_x, 2)
    _, points = coverage.process(np.ascontiguousarray(grid.reshape(-1, 2), np.float32))
    shape = grid.shape[:2]
    bound_m = points["position_error_bound_m"].reshape(shape).astype(np.float64)
    covering = points["n_covering"].reshape(shape).astype(np.int64)
    blind, snr_db = _pairs(site, grid, coverage.bistatic_constant, budget)
    return Plan(
        site=site,
        x_m=x_m,
        y_m=y_m,
        position_error_bound_m=bound_m,
        n_covering_pairs=covering,
        blind=blind,
        snr_db=snr_db,
        metrics={
            "covered_fraction": float(np.mean(np.isfinite(bound_m))),
            "covering_pairs_mean": float(np.mean(covering)),
            "blind_fraction": float(np.mean(blind)),
            "snr_min_db": float(np.min(snr_db)),
            "snr_median_db": float(np.median(snr_db)),
            "position_error_bound_p50_m": float(np.quantile(bound_m, 0.5)),
            "position_error_bound_p90_m": float(np.quantile(bound_m, 0.9, method="higher")),
            "path_sigma_m": float(budget.path_sigma_m),
        },
    )


def _centres(low: float, high: float, step: float) -> NDArray[np.float64]:
    count = max(2, round((high - low) / step))
    edges = np.linspace(low, high, count + 1)
    return np.asarray((edges[:-1] + edges[1:]) / 2.0)


def _pairs(
    site: Site, grid: NDArray[np.float64], bistatic_constant: float, budget: "_core.CoverageConfig"
) -> tuple[NDArray[np.bool_], NDArray[np.float64]]:
    """Return each pair's blind zone and SNR [dB], equation (2), over grid (n_y, n_x, 2)."""
    blind, snr_db = [], []
    for node in site.nodes:
        to_tx, to_rx = (
            np.linalg.norm(grid - end[:2], axis=-1) for end in (node.tx_position_m, node.rx_position_m)
        )
        excess_s = (
            to_tx + to_rx - math.dist(node.tx_position_m[:2], node.rx_position_m[:2])
        ) / SPEED_OF_LIGHT_MPS
        blind.append(excess_s < budget.blind_zone_s)
        with np.errstate(divide="ignore"):  # on an antenna
            loss_db = 10.0 * budget.path_loss_exponent * np.log10(to_tx * to_rx)
        snr_db.append(10.0 * math.log10(bistatic_constant) - loss_db)
    return np.array(blind), np.array(snr_db)
