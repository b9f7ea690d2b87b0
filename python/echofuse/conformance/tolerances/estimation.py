"""Tolerances of the estimators."""

from echofuse.conformance.tolerances._tolerance import Tolerance

ROWS: dict[str, Tolerance] = {
    "estimation.gaussian": Tolerance(
        5e-7, 0.0, "a polynomial of degree 7 in float32, relative to each value"
    ),
    "estimation.assignment.cost": Tolerance(1e-6, 0.0, "32 costs, summed and compared in float32"),
    "estimation.kalman.state": Tolerance(3e-6, 1e-6, "40 updates of up to 6 x 6 products in float32"),
    "estimation.kalman.covariance": Tolerance(1e-5, 0.0, "40 Joseph updates of up to 6 x 6, in float32"),
    "estimation.turning.state": Tolerance(1e-5, 1e-5, "240 updates of two filters, mixed, in float32"),
    "estimation.turning.covariance": Tolerance(1e-4, 0.0, "240 updates of two filters, mixed, in float32"),
    "estimation.turning.probability": Tolerance(0.0, 1e-4, "240 quotients of exponentials in float32"),
    "estimation.mixture.position": Tolerance(
        0.0, 1e-4, "[m] a sum over 600 particles, 20 m from the origin, a step"
    ),
    "estimation.mixture.velocity": Tolerance(1e-4, 1e-4, "[m/s] as the position"),
    "estimation.mixture.covariance": Tolerance(
        1e-3, 1e-5, "[m^2] a difference of moments about the former mean"
    ),
    "estimation.mixture.share": Tolerance(
        1e-4, 1e-5, "sums over 600 particles; slow where two components overlap"
    ),
    "estimation.mixture.likelihood": Tolerance(1e-5, 1e-5, "a mean of logarithms in float32"),
}
