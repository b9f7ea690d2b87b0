"""Cramér-Rao bounds of delay, range and position: what no estimator can beat on average.

See S. M. Kay, Fundamentals of Statistical Signal Processing I, sections 3.11 (range) and 3.9 (vectors).
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from echofuse.constants import SPEED_OF_LIGHT_MPS

__all__ = [
    "SPEED_OF_LIGHT_MPS",
    "bistatic_path_bound_m",
    "covariance_bound_m2",
    "delay_bound_s",
    "effective_bandwidth_rad_s",
    "monostatic_range_bound_m",
    "position_covariance_bound_m2",
    "position_error_bound_m",
]


def effective_bandwidth_rad_s(pulse: ArrayLike, sample_rate_hz: float) -> float:
    """Return beta = sqrt(int w^2 |S|^2 dw / int |S|^2 dw) of a sampled pulse (n,) [rad/s].

    Of a real pulse with its carrier this is the coherent beta; of its envelope (or of the complex pulse mixed
    down to its centre) the envelope's. The pulse must begin and end near zero.
    """
    samples = np.asarray(pulse)
    power = np.abs(np.fft.fft(samples)) ** 2
    omega = 2.0 * np.pi * np.fft.fftfreq(samples.size, 1.0 / sample_rate_hz)
    return float(np.sqrt(np.sum(omega**2 * power) / np.sum(power)))


def delay_bound_s(energy_ratio: ArrayLike, bandwidth_rad_s: float) -> NDArray[np.float64]:
    """Return the least standard deviation of a delay, 1 / (beta sqrt(2E/N0)) [s]; energy_ratio = 2E/N0."""
    return np.asarray(1.0 / (bandwidth_rad_s * np.sqrt(np.asarray(energy_ratio, np.float64))))


def monostatic_range_bound_m(energy_ratio: ArrayLike, bandwidth_rad_s: float) -> NDArray[np.float64]:
    """Return the least standard deviation of a one-way range, half of the delay's path [m]."""
    return 0.5 * bistatic_path_bound_m(energy_ratio, bandwidth_rad_s)


def bistatic_path_bound_m(energy_ratio: ArrayLike, bandwidth_rad_s: float) -> NDArray[np.float64]:
    """Return the least standard deviation of a path Tx -> person -> Rx [m]."""
    return SPEED_OF_LIGHT_MPS * delay_bound_s(energy_ratio, bandwidth_rad_s)


def position_covariance_bound_m2(
    position_m: ArrayLike, tx_m: ArrayLike, rx_m: ArrayLike, path_sigma_m: ArrayLike
) -> NDArray[np.float64]:
    """Return the least covariance (..., d, d) [m^2] of a position from the paths of n nodes.

    Parameters
    ----------
    position_m
        (..., d) where the person is, d = 2 or 3.
    tx_m, rx_m
        (n, d) antennas. Equal for a monostatic node, whose path is twice its range: J is the same whether one
        says path with sigma or range with sigma / 2.
    path_sigma_m
        (n,) or a number: standard deviation of the path Tx -> person -> Rx.

    J = sum_i u_i u_i^T / sigma_i^2, u_i = unit(z - tx_i) + unit(z - rx_i). Where the nodes do not determine
    the position the covariance is infinite.
    """
    position = np.asarray(position_m, np.float64)[..., np.newaxis, :]
    tx, rx = np.asarray(tx_m, np.float64), np.asarray(rx_m, np.float64)
    sigma = np.broadcast_to(np.asarray(path_sigma_m, np.float64), tx.shape[:-1])
    gradient = (_unit(position - tx) + _unit(position - rx)) / sigma[:, np.newaxis]
    return covariance_bound_m2(gradient)


def covariance_bound_m2(gradient: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the least covariance (..., d, d) [m^2], from each path's gradient over its sigma (..., n, d)."""
    information = np.einsum("...ni,...nj->...ij", gradient, gradient)
    determined = np.linalg.cond(information) < 1e12
    dimension = gradient.shape[-1]
    solvable = np.where(determined[..., np.newaxis, np.newaxis], information, np.eye(dimension))
    covariance = np.linalg.inv(solvable)
    return np.where(determined[..., np.newaxis, np.newaxis], covariance, np.inf)


def position_error_bound_m(
    position_m: ArrayLike, tx_m: ArrayLike, rx_m: ArrayLike, path_sigma_m: ArrayLike
) -> NDArray[np.float64]:
    """Return sqrt(trace) of `position_covariance_bound_m2`, shape (...) [m]."""
    covariance = position_covariance_bound_m2(position_m, tx_m, rx_m, path_sigma_m)
    return np.asarray(np.sqrt(np.trace(covariance, axis1=-2, axis2=-1)))


def _unit(vectors: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return vectors (..., d) of length 1; a vector of length 0 has no direction and stays 0."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(length > 0.0, length, 1.0)
