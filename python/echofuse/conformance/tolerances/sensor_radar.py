"""Tolerances of the pipeline's taps, where rounding has gone through all stages before."""

from echofuse.conformance.tolerances._tolerance import Tolerance

_SHIFT = "the parabola's curvature is 1e-2 of a correlation whose float32 sum carries 1e-7: up to 1e-5 sample"
_ALIGNED = (
    "float32 taps of the interpolator, and 1e-6 sample of shift on a slope of up to 1.6 amplitudes a sample"
)

ROWS: dict[str, Tolerance] = {
    "sensor_radar.scan": Tolerance(2e-7, 0.0, "a mean of a few float32 pulses"),
    "sensor_radar.envelope": Tolerance(1e-6, 0.0, "a sum of up to 16 float32 products and a root"),
    "sensor_radar.toa": Tolerance(
        0.0, 2e-4, "float32 of up to 1920 samples, and 1e-7 of the peak over its rise"
    ),
    "sensor_radar.path_threshold": Tolerance(1e-6, 0.0, "rms of up to 300 float32 samples"),
    "sensor_radar.shift": Tolerance(0.0, 5e-5, _SHIFT),
    "sensor_radar.correlation": Tolerance(0.0, 1e-6, "float32 sums over a scan"),
    "sensor_radar.aligned": Tolerance(3e-6, 0.0, _ALIGNED),
    "sensor_radar.residual": Tolerance(
        3e-6, 0.0, "of the scan's peak, for that is what was subtracted: " + _ALIGNED
    ),
    "sensor_radar.threshold": Tolerance(
        4e-6, 0.0, "its root, of the scan's peak: the residual's times a factor's root"
    ),
    "sensor_radar.position": Tolerance(
        3e-6, 2e-4, "the residual's over the edge's slope; float32 of up to 1920 samples"
    ),
    "sensor_radar.delay": Tolerance(3e-6, 3e-14, "the position's and the direct path's; float32 of 100 ns"),
    "sensor_radar.peak_mass": Tolerance(
        1e-4, 1e-5, "see estimation.mixture.share, times a mass good to 2e-5"
    ),
    "sensor_radar.track": Tolerance(3e-6, 2e-4, "[m], [m/s] as of hub.track.track and hub.track.kalman"),
    "sensor_radar.covariance": Tolerance(1e-3, 1e-5, "[m^2] see estimation.mixture.covariance"),
    "sensor_radar.free_delay": Tolerance(
        0.0, 6e-13, "an edge as slow as 1e-2 of its threshold a sample; 0.2 mm of path"
    ),
    "sensor_radar.free_kalman": Tolerance(
        0.0, 2e-3, "[m] the selection's tolerance twice: it feeds on its own tracks"
    ),
    "sensor_radar.free_phd": Tolerance(
        0.0, 5e-2, "[m] after a coin toss other particles: 0.2 m over the root of 100"
    ),
}
