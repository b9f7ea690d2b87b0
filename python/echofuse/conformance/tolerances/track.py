"""Tolerances of the trackers."""

from echofuse.conformance.tolerances._tolerance import Tolerance

ROWS: dict[str, Tolerance] = {
    "hub.track.moved": Tolerance(1e-6, 1e-6, "[m], [m/s] one step in float32, normals good to 1e-6"),
    "hub.track.weight": Tolerance(
        2e-5, 0.0, "d^2 / sigma^2 up to 25 is good to 1e-6 of itself, sums to 1e-6"
    ),
    "hub.track.mass": Tolerance(2e-5, 1e-6, "a sum of such weights"),
    "hub.track.peak": Tolerance(0.0, 1e-4, "[m], [m/s] see estimation.mixture"),
    "hub.track.track": Tolerance(2e-6, 2e-4, "[m], [m/s] from such peaks; faded while silent"),
    "hub.track.tall": Tolerance(
        0.0, 7e-4, "[m], [m/s] as through_wall.track, of a height that changes paths a third as much"
    ),
    "hub.track.tall_covariance": Tolerance(7e-4, 7e-6, "[m^2] as through_wall.covariance, likewise"),
    "hub.track.kalman": Tolerance(3e-6, 1e-5, "[m], [m/s] 40 frames of a 4 x 4 filter in float32"),
}
