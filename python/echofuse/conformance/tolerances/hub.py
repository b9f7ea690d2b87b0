"""Tolerances of the hub's stages."""

from echofuse.conformance.tolerances._tolerance import Tolerance

_FIX = (
    "Gauss-Newton ends at steps under 0.1 mm; float32 paths of 10 m carry 1e-6 m, times the geometry's factor"
)

ROWS: dict[str, Tolerance] = {
    "hub.path_length": Tolerance(1e-6, 1e-6, "two square roots and a sum in float32"),
    "hub.path_gradient": Tolerance(
        1e-5, 1e-5, "unit vectors in float32; at 10 cm from an antenna 1e-6 m is 1e-5"
    ),
    "hub.ellipse.position": Tolerance(0.0, 5e-4, _FIX),
    "hub.ellipse.start": Tolerance(
        1e-4, 1e-3, "normal equations square the condition, up to 1e3, of float32 rows"
    ),
    "hub.ellipse.range_residual": Tolerance(1e-4, 5e-4, _FIX),
    "hub.ellipse.equation_residual": Tolerance(1e-3, 5e-3, "rows of up to 500 m^3 in float32 leave 1e-3 m^3"),
    "hub.wall.excess": Tolerance(1e-6, 4e-6, "difference of two float32 lengths of up to 12 m"),
    "hub.wall.direction": Tolerance(0.0, 1e-5, "tangent in float32, over the little air of a grazing ray"),
    "hub.line.position": Tolerance(
        0.0, 1e-3, "a path of 16 m carries 1e-6 m in float32, times up to 500 across range for a 0.4 m array"
    ),
    "hub.line.covariance": Tolerance(2e-3, 0.0, "differences of unit vectors of 0.05 in float32, squared"),
    "hub.planar_3d.position": Tolerance(
        0.0, 1e-3, "a path of 14 m carries 1e-6 m in float32, times up to 500 across range for a 0.39 m cross"
    ),
    "hub.taylor_3d.position": Tolerance(
        0.0, 1e-3, "as hub.planar_3d.position, and a step that stops at 0.1 mm more or less"
    ),
    "hub.taylor_3d.covariance": Tolerance(
        1e-2, 0.0, "inverse of a 3 x 3 matrix of condition up to 1e4 in float32"
    ),
    "hub.taylor_3d.residual": Tolerance(0.0, 1e-5, "differences of two float32 paths of up to 14 m"),
    "hub.pairing.delay": Tolerance(1e-6, 0.0, "two products and a sum in float32"),
    "hub.selection.position": Tolerance(0.0, 1e-3, _FIX + "; a position far off the nodes' hull triples it"),
    "hub.selection.range_residual": Tolerance(1e-4, 1e-3, _FIX),
    "hub.selection.weight": Tolerance(1e-6, 1e-6, "a sum of at most 16 float32 weights"),
    "hub.point_clusters.position": Tolerance(1e-6, 1e-5, "running sums of up to 256 float32 positions"),
    "hub.point_clusters.weight": Tolerance(1e-6, 1e-5, "a sum of up to 256 float32 weights"),
    "hub.coverage.snr_db": Tolerance(1e-5, 1e-4, "powers and a logarithm in float32"),
    "hub.coverage.bound": Tolerance(1e-4, 1e-6, "inverse of a 2 x 2 matrix in float32, condition up to 1e3"),
    "hub.frame.weight": Tolerance(1e-7, 0.0, "carried through"),
    "hub.pipeline.tracks": Tolerance(
        0.0, 5e-3, "measurements agree to 1e-3 m, and a velocity is a difference of positions over 0.1 s"
    ),
    "hub.pipeline.phd_tracks": Tolerance(
        0.0,
        0.05,
        "one of some hundred particles drawn as its neighbour moves a peak, most of all its velocity",
    ),
    "hub.frame.path": Tolerance(1e-6, 0.0, "one float32 product"),
}
