"""Which pairs see a place, and how well a person can be located there (sensor-radar paper, section III)."""

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse.reference.hub.locate.site import Site, path_gradient

Array = NDArray[np.float64]

SPEED_OF_LIGHT_MPS = 299_792_458.0
BOLTZMANN_J_PER_K = 1.380649e-23
MIN_CONDITION = 1e-6


class CoverageConfig(Protocol):
    transmit_power_dbm: float
    noise_figure_db: float
    antenna_gain_db: float
    centre_hz: float
    bandwidth_hz: float
    pulse_interval_s: float
    pulses_per_scan: int
    radar_cross_section_m2: float
    noise_temperature_K: float
    path_loss_exponent: float
    frequency_exponent: float
    excess_path_loss_1m_db: float
    min_snr_db: float
    blind_zone_s: float
    path_sigma_m: float
    body_radius_m: float


class CoveragePoint(NamedTuple):
    n_covering: int
    n_blind: int
    best_snr_db: float
    third_snr_db: float
    position_error_bound_m: float
    margin: float


def from_db(db: float) -> float:
    return float(10 ** (db / 10))


def cassini_ratio(to_tx_m: float, to_rx_m: float, baseline_m: float) -> float:
    """(5): under 1 two loops, 1 a lemniscate, over 1 one loop."""
    return float(np.sqrt(to_tx_m * to_rx_m) / (baseline_m / 2))


def leg_product_m2(sum_m: float, baseline_m: float, bistatic_angle_rad: float) -> float:
    """(6): l_t l_r on the ellipse of a sum l_t + l_r."""
    return float((sum_m**2 - baseline_m**2) / (2 * (1 + np.cos(bistatic_angle_rad))))


def snr(bistatic_constant_m4: float, to_tx_m: float, to_rx_m: float) -> float:
    """(2)."""
    return bistatic_constant_m4 / (to_tx_m * to_rx_m) ** 2


def snr_on_ellipse(chi: float, sum_m: float, baseline_m: float, bistatic_angle_rad: float) -> float:
    """(7)."""
    return float(4 * chi * (1 + np.cos(bistatic_angle_rad)) ** 2 / (sum_m**2 - baseline_m**2) ** 2)


def sum_on_cassini_m(chi: float, snr: float, baseline_m: float, bistatic_angle_rad: float) -> float:
    """(8): l_t + l_r on the Cassini oval of an SNR."""
    return float(np.sqrt(baseline_m**2 + 2 * (1 + np.cos(bistatic_angle_rad)) * np.sqrt(chi / snr)))


def max_leg_product_m2(chi: float, min_snr: float) -> float:
    """(4)."""
    return float(np.sqrt(chi / min_snr))


def time_of_arrival_s(to_tx_m: float, to_rx_m: float) -> float:
    """Of an echo, after transmission [s]."""
    return (to_tx_m + to_rx_m) / SPEED_OF_LIGHT_MPS


def bistatic_constant(c: CoverageConfig, n_steps: int = 4000) -> float:
    """chi of (3) by integration over a flat band, each leg's loss from (9) [m^(2 rho)].

    Free space's 1 / (4 pi)^3 (c / f)^2 is 4 pi sigma f^2 / c^2 times the two legs' (c / (4 pi f))^2.
    """
    edges = np.linspace(c.centre_hz - c.bandwidth_hz / 2, c.centre_hz + c.bandwidth_hz / 2, n_steps + 1)
    f = (edges[1:] + edges[:-1]) / 2
    energy = from_db(c.transmit_power_dbm) * 1e-3 * c.pulse_interval_s * c.pulses_per_scan
    noise = BOLTZMANN_J_PER_K * c.noise_temperature_K * from_db(c.noise_figure_db)
    gain = from_db(c.antenna_gain_db) ** 2
    loss_1m = (4 * np.pi * c.centre_hz / SPEED_OF_LIGHT_MPS) ** 2 * from_db(c.excess_path_loss_1m_db)
    legs = (loss_1m * (f / c.centre_hz) ** (2 * (c.frequency_exponent + 1))) ** -2
    target = 4 * np.pi * c.radar_cross_section_m2 * f**2 / SPEED_OF_LIGHT_MPS**2
    return float(energy / noise * gain * np.mean(target * legs))


def position_error_bound_m(gradients: Array, path_sigma_m: float) -> float:
    """Cramer-Rao bound sqrt(tr J^-1) from the paths' gradients (n, 2); infinite if singular."""
    information = gradients.T @ gradients / path_sigma_m**2
    trace = float(np.trace(information))
    if trace == 0 or not np.linalg.det(information) > MIN_CONDITION * trace**2:
        return float("inf")
    return float(np.sqrt(np.trace(np.linalg.inv(information))))


def coverage(c: CoverageConfig, site: Site, position_m: Array) -> CoveragePoint:
    """One place (2,) [m] as the site sees it."""
    to_tx = np.linalg.norm(position_m - site.tx_m, axis=1)
    to_rx = np.linalg.norm(position_m - site.rx_m, axis=1)
    snr_db = 10 * np.log10(bistatic_constant(c) * (to_tx * to_rx) ** -c.path_loss_exponent)
    excess = to_tx + to_rx - np.linalg.norm(site.tx_m - site.rx_m, axis=1)
    blind_m = c.blind_zone_s * SPEED_OF_LIGHT_MPS
    blind = excess < blind_m
    covering = (snr_db >= c.min_snr_db) & ~blind
    ranked = np.sort(snr_db)[::-1]
    gradients = path_gradient(position_m, site.tx_m[covering], site.rx_m[covering], c.body_radius_m)
    margin = min(float(np.min(np.abs(excess - blind_m))), float(np.min(np.abs(snr_db - c.min_snr_db))))
    return CoveragePoint(
        int(covering.sum()),
        int(blind.sum()),
        float(ranked[0]),
        float(ranked[2]),
        position_error_bound_m(gradients, c.path_sigma_m),
        margin,
    )
