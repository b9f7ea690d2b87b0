"""Peaks of a particle density: Gaussian mixture by expectation-maximisation (Dempster et al. 1977)."""

from __future__ import annotations

from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from echofuse.reference.core.random import Pcg32
from echofuse.reference.estimation.gaussian import gaussian_kernel

X, VX, Y, VY, WEIGHT = range(5)
"""Columns of a particle array (n, 5): x [m], vx [m/s], y [m], vy [m/s], weight."""
EMPTY_SHARE = 1e-6
"""A component with less of the weight than this stays where it is, with share 0."""


class MixtureConfig(Protocol):
    """How peaks are looked for."""

    initialisation: str  # measurements | k_means_plus_plus
    restarts: int  # of k_means_plus_plus; the likeliest is kept
    initial_std_m: float  # [m] of every component at the start
    covariance_floor_m2: float  # [m^2] added to both variances
    background_density_per_m2: float  # [1/m^2] uniform component for what belongs to no peak; 0: none
    max_iterations: int
    tolerance_m: float  # [m] stop when no mean moved further in both coordinates


class Mixture(NamedTuple):
    """Components in the order of their seeds."""

    mean: NDArray[np.float64]  # (n, 2) [m]
    velocity: NDArray[np.float64]  # (n, 2) [m/s]
    covariance: NDArray[np.float64]  # (n, 2, 2) [m^2]
    share: NDArray[np.float64]  # (n,) of the particles' weight
    background: float  # share of the uniform component
    margin: float  # of the draws and stops on the way


def fit_mixture(
    particles: NDArray[np.float64],
    seeds: NDArray[np.float64],
    n_components: int,
    config: MixtureConfig,
    random: Pcg32,
) -> Mixture:
    """Fit ``n_components`` Gaussians to the positions of ``particles`` (n, 5).

    ``seeds`` (n_seeds, 3): x, y [m] and mass of where a peak may be; the heaviest are taken, and what they do
    not fill is drawn as k-means++ does (Arthur & Vassilvitskii 2007), one uniform number a draw.
    """
    weights = particles[:, WEIGHT] / particles[:, WEIGHT].sum()
    positions = particles[:, [X, Y]]
    if config.initialisation == "measurements":
        starts = [_best_seeds(seeds, n_components)]
    else:
        starts = [(np.zeros((0, 2)), np.inf)] * config.restarts
    best: Mixture | None = None
    best_likelihood, choice = -np.inf, np.inf
    for chosen, seed_margin in starts:
        centres, draw_margin = _fill(chosen, positions, weights, n_components, random)
        fitted = _iterate(particles, weights, centres, config, min(seed_margin, draw_margin))
        if len(starts) == 1:
            return fitted
        likelihood = log_likelihood(particles, fitted, config)
        choice = min(choice, abs(likelihood - best_likelihood), fitted.margin)
        if likelihood > best_likelihood:
            best, best_likelihood = fitted, likelihood
    assert best is not None
    return best._replace(margin=choice)


def log_likelihood(particles: NDArray[np.float64], mixture: Mixture, config: MixtureConfig) -> float:
    """Return the weighted mean of the log density of ``particles`` (n, 5) under ``mixture``."""
    weights = particles[:, WEIGHT] / particles[:, WEIGHT].sum()
    density = _densities(particles[:, [X, Y]], mixture).sum(axis=1)
    density = density + mixture.background * config.background_density_per_m2
    return float(weights @ np.log(np.maximum(density, 1e-12)))


def _best_seeds(seeds: NDArray[np.float64], n: int) -> tuple[NDArray[np.float64], float]:
    """Take the n heaviest seeds with any mass, heaviest first, and the margin of that order."""
    order = np.argsort(-seeds[:, 2], kind="stable")
    order = order[seeds[order, 2] > 0.0]
    masses = seeds[order[: n + 1], 2]
    margin = float(np.min(-np.diff(masses), initial=np.inf))
    return seeds[order[:n], :2], margin


def _fill(
    centres: NDArray[np.float64],
    positions: NDArray[np.float64],
    weights: NDArray[np.float64],
    n: int,
    random: Pcg32,
) -> tuple[NDArray[np.float64], float]:
    margin = np.inf
    while len(centres) < n:
        score = weights.copy()
        if len(centres) > 0:
            offsets = positions[:, None, :] - centres[None, :, :]
            score = weights * (offsets**2).sum(axis=2).min(axis=1)
        cumulative = np.cumsum(score)
        pointer = random.uniform() * cumulative[-1]
        index = int(min(np.searchsorted(cumulative, pointer, side="right"), len(score) - 1))
        margin = min(margin, float(np.abs(cumulative - pointer).min() / max(cumulative[-1], 1e-300)))
        centres = np.vstack([centres, positions[index]])
    return centres, margin


def _iterate(
    particles: NDArray[np.float64],
    weights: NDArray[np.float64],
    centres: NDArray[np.float64],
    config: MixtureConfig,
    margin: float,
) -> Mixture:
    n = len(centres)
    share = 1.0 / (n + (config.background_density_per_m2 > 0.0))
    mixture = Mixture(
        mean=centres,
        velocity=np.zeros((n, 2)),
        covariance=np.tile(np.eye(2) * config.initial_std_m**2, (n, 1, 1)),
        share=np.full(n, share),
        background=1.0 - n * share,
        margin=margin,
    )
    for _ in range(config.max_iterations):
        before = mixture.mean
        mixture = _step(particles, weights, mixture, config)
        moved = float(np.abs(mixture.mean - before).max(initial=0.0))
        mixture = mixture._replace(margin=min(mixture.margin, abs(moved / config.tolerance_m - 1.0)))
        if moved <= config.tolerance_m:
            break
    return mixture


def _step(
    particles: NDArray[np.float64], weights: NDArray[np.float64], mixture: Mixture, config: MixtureConfig
) -> Mixture:
    """One expectation and one maximisation."""
    positions, velocities = particles[:, [X, Y]], particles[:, [VX, VY]]
    densities = _densities(positions, mixture)
    background = np.full(len(weights), mixture.background * config.background_density_per_m2)
    total = densities.sum(axis=1) + background
    scale = np.divide(weights, total, out=np.zeros_like(weights), where=total > 0.0)
    parts = densities * scale[:, None]  # (n_particles, n_components) weight times responsibility
    sums = parts.sum(axis=0)
    everything = float(sums.sum() + background @ scale)
    mean, velocity, covariance = mixture.mean.copy(), mixture.velocity.copy(), mixture.covariance.copy()
    share = np.zeros_like(sums)
    for c in np.flatnonzero(sums > EMPTY_SHARE):
        mean[c] = parts[:, c] @ positions / sums[c]
        velocity[c] = parts[:, c] @ velocities / sums[c]
        offset = positions - mean[c]
        covariance[c] = (parts[:, c, None] * offset).T @ offset / sums[
            c
        ] + config.covariance_floor_m2 * np.eye(2)
        share[c] = sums[c] / everything
    stray = float(background @ scale) / everything if everything > 0.0 else 0.0
    return Mixture(mean, velocity, covariance, share, stray, mixture.margin)


def _densities(positions: NDArray[np.float64], mixture: Mixture) -> NDArray[np.float64]:
    """share_c N(position_i; mean_c, covariance_c), (n_particles, n_components) [1/m^2], cut at 5 sigma."""
    density = np.zeros((len(positions), len(mixture.mean)))
    for c, (mean, covariance, share) in enumerate(
        zip(mixture.mean, mixture.covariance, mixture.share, strict=True)
    ):
        offset = positions - mean
        squared = np.einsum("ni,ij,nj->n", offset, np.linalg.inv(covariance), offset)
        peak = share / (2.0 * np.pi * np.sqrt(np.linalg.det(covariance)))
        density[:, c] = peak * gaussian_kernel(squared)
    return density
