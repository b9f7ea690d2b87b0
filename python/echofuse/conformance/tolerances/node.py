"""Tolerances of the node's stages."""

from echofuse.conformance.tolerances._tolerance import Tolerance

_SHIFT = "a sub-sample shift is good to 1e-6 of a sample, which moves the largest sample by 1e-6 of itself"

ROWS: dict[str, Tolerance] = {
    "node.scan": Tolerance(1e-6, 1e-9, "sum of the pulses in float32"),
    "node.envelope": Tolerance(1e-6, 1e-9, "8 to 16 products in float32 beside the largest sample"),
    "node.direct_path": Tolerance(1e-6, 1e-4, "[sample] the noise to 1e-6, over the slope of the crossing"),
    "node.alignment": Tolerance(0.0, 1e-5, "see signal.alignment.shift"),
    "node.aligned": Tolerance(3e-6, 1e-9, _SHIFT),
    "node.residual": Tolerance(
        1e-4, 0.0, _SHIFT + "; the residual is down to 0.03 of what it is the difference of"
    ),
    "node.threshold": Tolerance(1e-4, 1e-9, "sums of squares of the residual"),
    "node.range_clusters": Tolerance(
        1e-6, 1e-3, "[sample] residual and threshold to 1e-4, over the edge's slope"
    ),
    "node.detections": Tolerance(1e-6, 1e-13, "[s] 1e-3 sample at 16 GHz; weights are equal"),
    "node.clutter": Tolerance(1e-6, 0.0, "a running mean in float32 of up to 30 scans"),
    "node.cfar.threshold": Tolerance(3e-6, 0.0, "sums of up to 128 squares in float32, factors to 1e-6"),
    "node.cfar.factor": Tolerance(2e-6, 0.0, "logarithm and exponential in float32"),
    "node.noise_floor": Tolerance(1e-6, 1e-9, "a sum of squares, a root and a running mean in float32"),
    "node.time_zero": Tolerance(0.0, 1e-4, "[sample] a parabola over a mean of ten responses in float32"),
    "node.weak_signal": Tolerance(1e-6, 0.0, "one quotient, and a noise of sums in float32"),
    "node.leading_edge": Tolerance(1e-6, 2e-6, "[sample] a quotient of differences in float32"),
    "node.largest_step": Tolerance(
        0.0, 1e-3, "[sample] a parabola of differences of sums of up to 1400 samples in float32"
    ),
    "node.target_trace": Tolerance(1e-6, 0.0, "[sample] one quotient in float32"),
    "node.range_cluster.position": Tolerance(
        1e-7, 2e-4, "[sample] two differences of float32 squares near 1"
    ),
}
