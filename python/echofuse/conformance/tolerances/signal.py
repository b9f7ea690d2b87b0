"""Tolerances of the signal stages."""

from echofuse.conformance.tolerances._tolerance import Tolerance

ROWS: dict[str, Tolerance] = {
    "signal.envelope": Tolerance(1e-6, 0.0, "8 to 16 products in float32 beside the largest sample"),
    "signal.envelope.low_pass": Tolerance(
        1e-3,
        0.0,
        "the root of a filtered square that cancels to 1e-7 of the largest square is 3e-4 of its sample",
    ),
    "signal.alignment.shift": Tolerance(
        0.0,
        1e-5,
        "1e-7 of the products, over the curvature of a 1 ns envelope's correlation (0.02 a sample^2)",
    ),
    "signal.alignment.correlation": Tolerance(
        2e-6, 0.0, "three sums of up to 1,920 float32 products, in blocks of 64"
    ),
    "signal.alignment.shifted": Tolerance(2e-6, 0.0, "taps of 1e-7, 16 products beside the largest sample"),
}
