"""Tolerances of the pipeline's taps, where rounding has gone through all stages before."""

from echofuse.conformance.tolerances._tolerance import Tolerance

_SHIFT = "the parabola's curvature is 1e-2 of a correlation whose float32 sum carries 1e-7: up to 1e-5 sample"
_ALIGNED = "float32 taps of the interpolator, and 1e-6 sample of shift on a slope of up to 1.6 amplitudes a sample"

ROWS: dict[str, Tolerance] = {
    "sensor_radar.scan": Tolerance(2e-7, 0.0, "a mean of a few float32 pulses"),
    "sensor_radar.envelope": Tolerance(1e-6, 0.0, "a sum of up to 16 float32 products and a root"),
    "sensor_radar.toa": Tolerance(0.0, 2e-4, "float32 of up to 1920 samples, and 1e-7 of the peak over its rise"),
    "sensor_radar.path_threshold": Tolerance(1e-6, 0.0, "rms of up to 300 float32 samples"),
    "sensor_radar.shift": Tolerance(0.0, 5e-5, _SHIFT),
    "sensor_radar.correlation": Tolerance(0.0, 1e-6, "float32 sums over a scan"),
    "sensor_radar.aligned": Tolerance(3e-6, 0.0, _ALIGNED),
    "sensor_radar.residual": Tolerance(3e-6, 0.0, "of the scan's peak, for that is what was subtracted: " + _ALIGNED),
    "sensor_radar.threshold": Tolerance(4e-6, 0.0, "its root, of the scan's peak: the residual's times a factor's root"),
    "sensor_radar.position": Tolerance(3e-6, 2e-4, "the residual's over the edge's slope; float32 of up to 1920 samples"),
    "sensor_radar.delay": Tolerance(3e-6, 3e-14, "the position's and the direct path's; float32 of 100 ns"),
}
