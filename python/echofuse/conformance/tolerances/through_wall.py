"""Tolerances of the through-wall pipeline's taps, where rounding has gone through all stages before."""

from echofuse.conformance.tolerances._tolerance import Tolerance

ROWS: dict[str, Tolerance] = {
    "through_wall.carried": Tolerance(0.0, 0.0, "samples are moved, not computed"),
    "through_wall.fraction": Tolerance(0.0, 1e-4, "[sample] see node.time_zero"),
    "through_wall.subtracted": Tolerance(
        1e-6, 0.0, "of the response's peak, for that is what was subtracted: a running mean in float32"
    ),
    "through_wall.enhanced": Tolerance(
        2e-6, 0.0, "of the peak over the divisor: both parts of a quotient as through_wall.subtracted"
    ),
    "through_wall.trace": Tolerance(1e-6, 0.0, "[sample] see node.target_trace"),
    "through_wall.edge": Tolerance(
        1e-6, 3e-5, "of the peak, over the edge's rise; float32 of up to 700 samples"
    ),
    "through_wall.delay": Tolerance(
        1e-6, 3e-14, "the edge's and the cross-talk's fraction; float32 of 100 ns"
    ),
    "through_wall.point": Tolerance(0.0, 5e-5, "[m] cross-range is paths' differences times ten, of float32"),
    "through_wall.point_in_space": Tolerance(
        0.0, 2.5e-4, "[m] the Taylor series ends at steps of 1e-4 m: float32 takes one more or fewer"
    ),
    "through_wall.track_of_points": Tolerance(
        0.0, 5e-4, "[m], [m/s] filters of such points; a velocity takes up twice a point's error a second"
    ),
    "through_wall.track": Tolerance(0.0, 2e-4, "[m], [m/s] 70 frames of such differences in float32"),
    "through_wall.covariance": Tolerance(2e-4, 2e-6, "[m^2] from the gradients at such tracks"),
}
