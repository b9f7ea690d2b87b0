"""
The C++ library, as it runs on nodes and hub. Private: use the modules of echofuse instead.
"""

from __future__ import annotations
import collections.abc
import numpy
import numpy.typing
import typing

__all__: list[str] = [
    "Aligner",
    "Alignment",
    "AlignmentConfig",
    "AlignmentMethod",
    "Area",
    "AssociationRule",
    "Box",
    "CfarConfig",
    "CfarDetector",
    "CfarMethod",
    "ClosingRule",
    "ClusterDistance",
    "ClusterRepresentative",
    "ClutterConfig",
    "ClutterFilter",
    "ClutterMethod",
    "ClutterSpread",
    "ConstantVelocityFilter",
    "ConstantVelocityFilter3d",
    "Coverage",
    "CoverageConfig",
    "DirectPath",
    "DirectPathConfig",
    "DirectPathSearch",
    "DirectPathSearcher",
    "EdgeRule",
    "EllipseConfig",
    "EllipseFix",
    "EllipseLeastSquares",
    "EllipseRefinement",
    "Envelope",
    "EnvelopeConfig",
    "EnvelopeMethod",
    "FrameAssembler",
    "FrameAssemblerConfig",
    "FrameAssemblerCounters",
    "GaussianCfarConfig",
    "GaussianCfarDetector",
    "KalmanTracker",
    "KalmanTracker3d",
    "LIMITS",
    "LeadingEdge",
    "LeadingEdgeConfig",
    "LineFix",
    "LineFixStatus",
    "LineLocator",
    "LineLocatorConfig",
    "LinkMachine",
    "LinkReader",
    "MEASUREMENT_STAGES_BYTES",
    "MeasurementSelection",
    "MixtureConfig",
    "MixtureFitter",
    "NodeSite",
    "NodeSite3d",
    "NoiseFloor",
    "NoiseFloorConfig",
    "PairingRule",
    "PathTracker",
    "PathTracker3d",
    "PathTrackerConfig",
    "Pcg32",
    "PeakInitialisation",
    "PhdConfig",
    "PhdFilter",
    "PhdTracker",
    "Planar3dFix",
    "Planar3dMethod",
    "Planar3dStatus",
    "Point",
    "Point3",
    "PointClusterConfig",
    "PointClusters",
    "PulseIntegrator",
    "PulseIntegratorConfig",
    "RangeClusterConfig",
    "RangeClusterer",
    "RangeKind",
    "RangeTracker",
    "RangeTrackerConfig",
    "ResamplingChance",
    "SENSOR_RADAR_HUB_BYTES",
    "SENSOR_RADAR_NODE_BYTES",
    "SelectionConfig",
    "SelectionCounters",
    "SelectionMethod",
    "SelectionResidual",
    "SensorRadarHub",
    "SensorRadarHubConfig",
    "SensorRadarNode",
    "SensorRadarNodeConfig",
    "Status",
    "TAPS",
    "THROUGH_WALL_3D_HUB_BYTES",
    "THROUGH_WALL_HUB_BYTES",
    "THROUGH_WALL_NODE_BYTES",
    "TargetTraceConfig",
    "TargetTracer",
    "Taylor3d",
    "Taylor3dConfig",
    "Taylor3dFix",
    "Taylor3dStart",
    "Taylor3dStatus",
    "ThroughWall3dHub",
    "ThroughWall3dHubConfig",
    "ThroughWallHub",
    "ThroughWallHubConfig",
    "ThroughWallNode",
    "ThroughWallNodeConfig",
    "TimeZero",
    "TimeZeroConfig",
    "TimeZeroFinder",
    "TimeZeroResult",
    "TracePairing",
    "TracePairingConfig",
    "TrackManager",
    "TrackManager3d",
    "TrackManagerConfig",
    "TrackState",
    "TrackUpdate",
    "Tracker",
    "TransferKind",
    "TurningFilter",
    "TurningFilter3d",
    "Wall",
    "WallCompensation",
    "WallConfig",
    "WeakSignalConfig",
    "WeakSignalEnhancer",
    "assign",
    "cassini_ratio",
    "crc16",
    "crc32c",
    "decode_detections",
    "decode_spatial_tracks",
    "decode_tracks",
    "encode_detections",
    "encode_spatial_tracks",
    "encode_tracks",
    "gaussian_kernel",
    "hub_registers",
    "invalid_site",
    "leg_product_m2",
    "max_leg_product_m2",
    "node_registers",
    "path_length",
    "planar_3d",
    "rectify",
    "snr",
    "snr_on_ellipse",
    "sum_on_cassini_m",
    "systematic_resample",
    "through_wall_3d_hub_registers",
    "through_wall_hub_registers",
    "through_wall_node_registers",
    "time_of_arrival_s",
    "two_ellipses",
    "write_frame",
]

class Status:
    """
    What a stage says of one call.

    Members:

      ok : done, outputs complete

      truncated : a capacity was reached: what the outputs hold is valid, something was left out

      not_configured : configure() has not succeeded yet; outputs empty

      invalid_config : the configuration is impossible; the earlier one stays in force

      invalid_input : the data cannot be used; outputs empty
    """

    __members__: typing.ClassVar[dict[str, Status]]
    invalid_config: typing.ClassVar[Status]
    invalid_input: typing.ClassVar[Status]
    not_configured: typing.ClassVar[Status]
    ok: typing.ClassVar[Status]
    truncated: typing.ClassVar[Status]
    @typing.overload
    def __eq__(self, other: Status) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: Status) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class Pcg32:
    """
    PCG-XSH-RR 64/32; every number takes one 32-bit draw.
    """
    def __init__(
        self,
        seed: typing.SupportsInt | typing.SupportsIndex = 0,
        stream: typing.SupportsInt | typing.SupportsIndex = 0,
    ) -> None: ...
    def next_u32(self) -> int: ...
    def normal(self) -> float:
        """
        Standard normal, within +-5.42.
        """
    def normals(self, n: typing.SupportsInt | typing.SupportsIndex) -> numpy.typing.NDArray[numpy.float32]:
        """
        The next n normals, (n,).
        """
    def uniform(self) -> float:
        """
        In [0, 1), a multiple of 2^-24.
        """
    def uniforms(self, n: typing.SupportsInt | typing.SupportsIndex) -> numpy.typing.NDArray[numpy.float32]:
        """
        The next n uniforms, (n,).
        """

class EnvelopeMethod:
    """
    How the envelope is taken.

    Members:

      hilbert : |r + jH(r)|

      square_low_pass : sqrt(2 LPF(r^2))
    """

    __members__: typing.ClassVar[dict[str, EnvelopeMethod]]
    hilbert: typing.ClassVar[EnvelopeMethod]
    square_low_pass: typing.ClassVar[EnvelopeMethod]
    @typing.overload
    def __eq__(self, other: EnvelopeMethod) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: EnvelopeMethod) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class EnvelopeConfig:
    """
    Amplitude envelope of a scan.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> EnvelopeConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> EnvelopeConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        method: EnvelopeMethod = ...,
        hilbert_half_length_samples: int = 11,
        low_pass_half_length_samples: int = 15,
        low_pass_cutoff_hz: float = 1100000000.0,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def hilbert_half_length_samples(self) -> int:
        """
        [sample] taps on each side
        """
    @hilbert_half_length_samples.setter
    def hilbert_half_length_samples(self, value: int) -> None: ...
    @property
    def low_pass_cutoff_hz(self) -> float:
        """
        [Hz] below half the sample rate
        """
    @low_pass_cutoff_hz.setter
    def low_pass_cutoff_hz(self, value: float) -> None: ...
    @property
    def low_pass_half_length_samples(self) -> int:
        """
        [sample] taps on each side
        """
    @low_pass_half_length_samples.setter
    def low_pass_half_length_samples(self, value: int) -> None: ...
    @property
    def method(self) -> EnvelopeMethod:
        """
        how the envelope is taken
        """
    @method.setter
    def method(self, value: EnvelopeMethod) -> None: ...

class Envelope:
    """
    Amplitude envelope of a scan.
    """
    def __init__(self) -> None: ...
    def configure(
        self, config: EnvelopeConfig, sample_rate_hz: typing.SupportsFloat | typing.SupportsIndex
    ) -> Status: ...
    def process(
        self, scan: numpy.typing.NDArray[numpy.float32]
    ) -> tuple[Status, numpy.typing.NDArray[numpy.float32]]:
        """
        (status, envelope): both (n_samples,) [count].
        """
    def reach_samples(self) -> int:
        """
        [sample] how far a sample spreads
        """

class AlignmentMethod:
    """
    How finely scans are aligned.

    Members:

      sub_sample : whole shift and a fraction

      integer : whole shift

      none : no shift
    """

    __members__: typing.ClassVar[dict[str, AlignmentMethod]]
    integer: typing.ClassVar[AlignmentMethod]
    none: typing.ClassVar[AlignmentMethod]
    sub_sample: typing.ClassVar[AlignmentMethod]
    @typing.overload
    def __eq__(self, other: AlignmentMethod) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: AlignmentMethod) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class AlignmentConfig:
    """
    Alignment of scans with the background.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> AlignmentConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> AlignmentConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        method: AlignmentMethod = ...,
        max_shift_samples: int = 8,
        window_samples: int = 512,
        interpolator_half_length_samples: int = 8,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def interpolator_half_length_samples(self) -> int:
        """
        [sample] taps on each side
        """
    @interpolator_half_length_samples.setter
    def interpolator_half_length_samples(self, value: int) -> None: ...
    @property
    def max_shift_samples(self) -> int:
        """
        [sample] searched on each side
        """
    @max_shift_samples.setter
    def max_shift_samples(self, value: int) -> None: ...
    @property
    def method(self) -> AlignmentMethod:
        """
        how finely
        """
    @method.setter
    def method(self, value: AlignmentMethod) -> None: ...
    @property
    def window_samples(self) -> int:
        """
        [sample] compared, around the background's strongest one; >= 8
        """
    @window_samples.setter
    def window_samples(self, value: int) -> None: ...

class Alignment:
    """
    Delay of a scan against a reference.
    """
    @property
    def correlation(self) -> float:
        """
        [1] normalised, at the best whole shift
        """
    @property
    def shift_samples(self) -> float:
        """
        [sample] how much later
        """

class Aligner:
    """
    Finds and undoes the delay of a scan.
    """
    def __init__(self) -> None: ...
    def configure(self, config: AlignmentConfig) -> Status: ...
    def estimate(
        self,
        envelope: numpy.typing.NDArray[numpy.float32],
        reference: numpy.typing.NDArray[numpy.float32],
        coarse_shift: typing.SupportsInt | typing.SupportsIndex,
        first: typing.SupportsInt | typing.SupportsIndex,
        last: typing.SupportsInt | typing.SupportsIndex,
    ) -> tuple[Status, Alignment]:
        """
        (status, alignment); envelope, reference (n_samples,) [count].
        """
    def shift(
        self,
        input: numpy.typing.NDArray[numpy.float32],
        shift_samples: typing.SupportsFloat | typing.SupportsIndex,
    ) -> tuple[Status, numpy.typing.NDArray[numpy.float32]]:
        """
        (status, output): input (n_samples,) read at k + shift_samples.
        """

class ConstantVelocityFilter:
    """
    State x, vx, y, vy and its covariance.
    """
    def __init__(
        self, state: numpy.typing.NDArray[numpy.float32], covariance: numpy.typing.NDArray[numpy.float32]
    ) -> None: ...
    def predict(
        self,
        dt_s: typing.SupportsFloat | typing.SupportsIndex,
        acceleration_density_m2ps3: typing.SupportsFloat | typing.SupportsIndex,
        velocity_decay: typing.SupportsFloat | typing.SupportsIndex = 1.0,
    ) -> None: ...
    def update(
        self,
        position_m: numpy.typing.NDArray[numpy.float32],
        measurement_covariance_m2: numpy.typing.NDArray[numpy.float32],
    ) -> None: ...
    def update_along(
        self,
        direction: numpy.typing.NDArray[numpy.float32],
        innovation_m: typing.SupportsFloat | typing.SupportsIndex,
        variance_m2: typing.SupportsFloat | typing.SupportsIndex,
    ) -> None: ...
    @property
    def covariance(self) -> numpy.typing.NDArray[numpy.float32]: ...
    @property
    def state(self) -> numpy.typing.NDArray[numpy.float32]: ...

class ConstantVelocityFilter3d:
    """
    State x, vx, y, vy, z, vz and its covariance.
    """
    def __init__(
        self, state: numpy.typing.NDArray[numpy.float32], covariance: numpy.typing.NDArray[numpy.float32]
    ) -> None: ...
    def predict(
        self,
        dt_s: typing.SupportsFloat | typing.SupportsIndex,
        acceleration_density_m2ps3: typing.SupportsFloat | typing.SupportsIndex,
        velocity_decay: typing.SupportsFloat | typing.SupportsIndex = 1.0,
    ) -> None: ...
    def update(
        self,
        position_m: numpy.typing.NDArray[numpy.float32],
        measurement_covariance_m2: numpy.typing.NDArray[numpy.float32],
    ) -> None: ...
    def update_along(
        self,
        direction: numpy.typing.NDArray[numpy.float32],
        innovation_m: typing.SupportsFloat | typing.SupportsIndex,
        variance_m2: typing.SupportsFloat | typing.SupportsIndex,
    ) -> None: ...
    @property
    def covariance(self) -> numpy.typing.NDArray[numpy.float32]: ...
    @property
    def state(self) -> numpy.typing.NDArray[numpy.float32]: ...

class TurningFilter:
    """
    ConstantVelocityFilter of one who walks straight, or turns.
    """
    def __init__(
        self,
        state: numpy.typing.NDArray[numpy.float32],
        covariance: numpy.typing.NDArray[numpy.float32],
        turns: bool,
    ) -> None: ...
    def hold(
        self,
        axis: typing.SupportsInt | typing.SupportsIndex,
        low_m: typing.SupportsFloat | typing.SupportsIndex,
        high_m: typing.SupportsFloat | typing.SupportsIndex,
    ) -> None: ...
    def predict(
        self,
        dt_s: typing.SupportsFloat | typing.SupportsIndex,
        straight_density_m2ps3: typing.SupportsFloat | typing.SupportsIndex,
        turning_density_m2ps3: typing.SupportsFloat | typing.SupportsIndex,
        begin_probability: typing.SupportsFloat | typing.SupportsIndex,
        end_probability: typing.SupportsFloat | typing.SupportsIndex,
        velocity_decay: typing.SupportsFloat | typing.SupportsIndex = 1.0,
    ) -> None: ...
    def update_along(
        self,
        direction: numpy.typing.NDArray[numpy.float32],
        innovation_m: typing.SupportsFloat | typing.SupportsIndex,
        variance_m2: typing.SupportsFloat | typing.SupportsIndex,
    ) -> None: ...
    @property
    def covariance(self) -> numpy.typing.NDArray[numpy.float32]: ...
    @property
    def state(self) -> numpy.typing.NDArray[numpy.float32]: ...
    @property
    def turning_probability(self) -> float: ...

class TurningFilter3d:
    """
    ConstantVelocityFilter3d of one who walks straight, or turns.
    """
    def __init__(
        self,
        state: numpy.typing.NDArray[numpy.float32],
        covariance: numpy.typing.NDArray[numpy.float32],
        turns: bool,
    ) -> None: ...
    def hold(
        self,
        axis: typing.SupportsInt | typing.SupportsIndex,
        low_m: typing.SupportsFloat | typing.SupportsIndex,
        high_m: typing.SupportsFloat | typing.SupportsIndex,
    ) -> None: ...
    def predict(
        self,
        dt_s: typing.SupportsFloat | typing.SupportsIndex,
        straight_density_m2ps3: typing.SupportsFloat | typing.SupportsIndex,
        turning_density_m2ps3: typing.SupportsFloat | typing.SupportsIndex,
        begin_probability: typing.SupportsFloat | typing.SupportsIndex,
        end_probability: typing.SupportsFloat | typing.SupportsIndex,
        velocity_decay: typing.SupportsFloat | typing.SupportsIndex = 1.0,
    ) -> None: ...
    def update_along(
        self,
        direction: numpy.typing.NDArray[numpy.float32],
        innovation_m: typing.SupportsFloat | typing.SupportsIndex,
        variance_m2: typing.SupportsFloat | typing.SupportsIndex,
    ) -> None: ...
    @property
    def covariance(self) -> numpy.typing.NDArray[numpy.float32]: ...
    @property
    def state(self) -> numpy.typing.NDArray[numpy.float32]: ...
    @property
    def turning_probability(self) -> float: ...

class PeakInitialisation:
    """
    Where the search for peaks begins.

    Members:

      measurements

      k_means_plus_plus
    """

    __members__: typing.ClassVar[dict[str, PeakInitialisation]]
    k_means_plus_plus: typing.ClassVar[PeakInitialisation]
    measurements: typing.ClassVar[PeakInitialisation]
    @typing.overload
    def __eq__(self, other: PeakInitialisation) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: PeakInitialisation) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class MixtureConfig:
    """
    Gaussian mixture by expectation-maximisation.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    initialisation: PeakInitialisation
    max_iterations: int
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> MixtureConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> MixtureConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        initialisation: PeakInitialisation = ...,
        restarts: int = 3,
        initial_std_m: float = 0.2,
        covariance_floor_m2: float = 0.001,
        background_density_per_m2: float = 0.01,
        max_iterations: int = 15,
        tolerance_m: float = 0.001,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def background_density_per_m2(self) -> float:
        """
        [1/m^2], 0: none
        """
    @background_density_per_m2.setter
    def background_density_per_m2(self, value: float) -> None: ...
    @property
    def covariance_floor_m2(self) -> float:
        """
        [m^2]
        """
    @covariance_floor_m2.setter
    def covariance_floor_m2(self, value: float) -> None: ...
    @property
    def initial_std_m(self) -> float:
        """
        [m]
        """
    @initial_std_m.setter
    def initial_std_m(self, value: float) -> None: ...
    @property
    def restarts(self) -> int:
        """
        of k_means_plus_plus
        """
    @restarts.setter
    def restarts(self, value: int) -> None: ...
    @property
    def tolerance_m(self) -> float:
        """
        [m]
        """
    @tolerance_m.setter
    def tolerance_m(self, value: float) -> None: ...

class MixtureFitter:
    """
    Peaks of a particle density.
    """
    def __init__(self) -> None: ...
    def configure(self, config: MixtureConfig) -> Status: ...
    def log_likelihood(
        self,
        particles: numpy.typing.NDArray[numpy.float32],
        components: typing.Annotated[numpy.typing.ArrayLike, numpy.void],
        background: typing.SupportsFloat | typing.SupportsIndex,
    ) -> float:
        """
        Weighted mean log density of particles (n, 5).
        """
    def process(
        self,
        particles: numpy.typing.NDArray[numpy.float32],
        seeds: numpy.typing.NDArray[numpy.float32],
        n_components: typing.SupportsInt | typing.SupportsIndex,
        random: Pcg32,
    ) -> tuple[Status, numpy.typing.NDArray[numpy.void], float]:
        """
        (status, structured array of MixtureComponent, background share) of particles (n, 5) and seeds (s, 3).
        """

class PulseIntegratorConfig:
    """
    Coherent integration of pulses.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> PulseIntegratorConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> PulseIntegratorConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(self, *, pulses_per_scan: int = 1) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def pulses_per_scan(self) -> int:
        """
        pulse responses averaged into one scan, >= 1
        """
    @pulses_per_scan.setter
    def pulses_per_scan(self, value: int) -> None: ...

class PulseIntegrator:
    """
    Mean of every N_s pulse responses.
    """
    def __init__(self) -> None: ...
    def configure(self, config: PulseIntegratorConfig) -> Status: ...
    def process(self, pulse: numpy.typing.NDArray[numpy.float32]) -> tuple[Status, typing.Any]:
        """
        (status, scan (n_samples,) or None while incomplete).
        """
    def reset(self) -> None: ...

class DirectPathSearch:
    """
    How the direct path's leading edge is searched.

    Members:

      serial_backward

      threshold_crossing

      jump_back_search_forward
    """

    __members__: typing.ClassVar[dict[str, DirectPathSearch]]
    jump_back_search_forward: typing.ClassVar[DirectPathSearch]
    serial_backward: typing.ClassVar[DirectPathSearch]
    threshold_crossing: typing.ClassVar[DirectPathSearch]
    @typing.overload
    def __eq__(self, other: DirectPathSearch) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: DirectPathSearch) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class DirectPathConfig:
    """
    Time of arrival of the direct path.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> DirectPathConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> DirectPathConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        search: DirectPathSearch = ...,
        noise_samples: int = 300,
        early_detection_probability: float = 0.01,
        window_samples: int = 60,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def early_detection_probability(self) -> float:
        """
        that noise crosses within noise_samples, in (1e-6, 1)
        """
    @early_detection_probability.setter
    def early_detection_probability(self, value: float) -> None: ...
    @property
    def noise_samples(self) -> int:
        """
        [sample] that give the noise, >= 8
        """
    @noise_samples.setter
    def noise_samples(self, value: int) -> None: ...
    @property
    def search(self) -> DirectPathSearch:
        """
        from where to where
        """
    @search.setter
    def search(self, value: DirectPathSearch) -> None: ...
    @property
    def window_samples(self) -> int:
        """
        [sample] searched before the peak
        """
    @window_samples.setter
    def window_samples(self, value: int) -> None: ...

class DirectPath:
    """
    Where the direct path arrives.
    """
    @property
    def found(self) -> bool: ...
    @property
    def peak_sample(self) -> int:
        """
        [sample]
        """
    @property
    def threshold(self) -> float:
        """
        [count]
        """
    @property
    def toa_samples(self) -> float:
        """
        [sample]; 0 unless found
        """

class DirectPathSearcher:
    """
    Time of arrival of the direct path.
    """
    def __init__(self) -> None: ...
    def configure(self, config: DirectPathConfig) -> Status: ...
    def process(self, envelope: numpy.typing.NDArray[numpy.float32]) -> tuple[Status, DirectPath]:
        """
        (status, direct path): envelope (n_samples,) [count].
        """
    def threshold_factor(self) -> float:
        """
        threshold over sigma [1]
        """

class ClutterMethod:
    """
    What is taken as background.

    Members:

      empty_room_envelope : envelope less the empty room's

      empty_room_scan : scan less the empty room's

      empty_room_shadowed : scan less what people's shadows leave of the empty room's

      exponential_average : scan less its mean so far

      frame_difference : scan less an earlier scan
    """

    __members__: typing.ClassVar[dict[str, ClutterMethod]]
    empty_room_envelope: typing.ClassVar[ClutterMethod]
    empty_room_scan: typing.ClassVar[ClutterMethod]
    empty_room_shadowed: typing.ClassVar[ClutterMethod]
    exponential_average: typing.ClassVar[ClutterMethod]
    frame_difference: typing.ClassVar[ClutterMethod]
    @typing.overload
    def __eq__(self, other: ClutterMethod) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: ClutterMethod) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class ClutterConfig:
    """
    Removal of what stands still.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> ClutterConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> ClutterConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        method: ClutterMethod = ...,
        averaging_factor: float = 0.95,
        learning_scans: int = 20,
        difference_lag_scans: int = 1,
        shadow_window_samples: int = 31,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def averaging_factor(self) -> float:
        """
        weight of the past, in (0, 1)
        """
    @averaging_factor.setter
    def averaging_factor(self, value: float) -> None: ...
    @property
    def difference_lag_scans(self) -> int:
        """
        frame difference: how much earlier
        """
    @difference_lag_scans.setter
    def difference_lag_scans(self, value: int) -> None: ...
    @property
    def learning_scans(self) -> int:
        """
        scans that make a background, >= 1
        """
    @learning_scans.setter
    def learning_scans(self, value: int) -> None: ...
    @property
    def method(self) -> ClutterMethod:
        """
        what is taken as background
        """
    @method.setter
    def method(self, value: ClutterMethod) -> None: ...
    @property
    def shadow_window_samples(self) -> int:
        """
        odd, 3 to 127
        """
    @shadow_window_samples.setter
    def shadow_window_samples(self, value: int) -> None: ...

class ClutterFilter:
    """
    Difference from a background.
    """
    def __init__(self) -> None: ...
    def add_empty_room(self, samples: numpy.typing.NDArray[numpy.float32]) -> Status:
        """
        samples (n_samples,) [count]
        """
    def configure(
        self, config: ClutterConfig, n_samples: typing.SupportsInt | typing.SupportsIndex
    ) -> Status: ...
    def process(
        self, samples: numpy.typing.NDArray[numpy.float32]
    ) -> tuple[Status, numpy.typing.NDArray[numpy.float32]]:
        """
        (status, residual): both (n_samples,) [count], signed.
        """
    def ready(self) -> bool: ...
    def reset(self) -> None: ...

class CfarMethod:
    """
    Where the threshold comes from.

    Members:

      double_threshold_buffer : Algorithm 1, both directions

      cell_averaging

      global_average

      ordered_statistic
    """

    __members__: typing.ClassVar[dict[str, CfarMethod]]
    cell_averaging: typing.ClassVar[CfarMethod]
    double_threshold_buffer: typing.ClassVar[CfarMethod]
    global_average: typing.ClassVar[CfarMethod]
    ordered_statistic: typing.ClassVar[CfarMethod]
    @typing.overload
    def __eq__(self, other: CfarMethod) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: CfarMethod) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class CfarConfig:
    """
    Detector with a constant false-alarm rate.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> CfarConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> CfarConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        method: CfarMethod = ...,
        false_alarm_probability: float = 0.0001,
        training_cells_per_side: int = 32,
        guard_cells_per_side: int = 16,
        ordered_rank_fraction: float = 0.75,
        local_factor: float = 5.0,
        global_factor: float = 8.0,
        buffer_samples: int = 25,
        max_rises: int = 4,
        rise_threshold_factor: float = 0.1,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def buffer_samples(self) -> int:
        """
        [sample] buffer: 1 .. 128
        """
    @buffer_samples.setter
    def buffer_samples(self, value: int) -> None: ...
    @property
    def false_alarm_probability(self) -> float:
        """
        per sample, in [1e-9, 0.5]
        """
    @false_alarm_probability.setter
    def false_alarm_probability(self, value: float) -> None: ...
    @property
    def global_factor(self) -> float:
        """
        buffer: weight of the global power, >= 0
        """
    @global_factor.setter
    def global_factor(self, value: float) -> None: ...
    @property
    def guard_cells_per_side(self) -> int:
        """
        [sample] >= 0
        """
    @guard_cells_per_side.setter
    def guard_cells_per_side(self, value: int) -> None: ...
    @property
    def local_factor(self) -> float:
        """
        buffer: weight of the local power, > 0
        """
    @local_factor.setter
    def local_factor(self, value: float) -> None: ...
    @property
    def max_rises(self) -> int:
        """
        buffer: more rises freeze the local power
        """
    @max_rises.setter
    def max_rises(self, value: int) -> None: ...
    @property
    def method(self) -> CfarMethod:
        """
        where the threshold comes from
        """
    @method.setter
    def method(self, value: CfarMethod) -> None: ...
    @property
    def ordered_rank_fraction(self) -> float:
        """
        rank over cells, in (0, 1]
        """
    @ordered_rank_fraction.setter
    def ordered_rank_fraction(self, value: float) -> None: ...
    @property
    def rise_threshold_factor(self) -> float:
        """
        buffer: a rise over the global power
        """
    @rise_threshold_factor.setter
    def rise_threshold_factor(self, value: float) -> None: ...
    @property
    def training_cells_per_side(self) -> int:
        """
        [sample] 1 .. 64
        """
    @training_cells_per_side.setter
    def training_cells_per_side(self, value: int) -> None: ...

class CfarDetector:
    """
    Decides sample by sample.
    """
    def __init__(self) -> None: ...
    def configure(self, config: CfarConfig) -> Status: ...
    def factor(self, n_cells: typing.SupportsInt | typing.SupportsIndex) -> float:
        """
        threshold over the cells' mean or ranked one
        """
    def min_samples(self) -> int:
        """
        [sample] the shortest scan
        """
    def process(self, amplitude: numpy.typing.NDArray[numpy.float32]) -> tuple:
        """
        (status, threshold [count^2], decisions uint8): all (n_samples,); amplitude in [count].
        """

class NoiseFloorConfig:
    """
    Least threshold, from the quietest part of the scans.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> NoiseFloorConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> NoiseFloorConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self, *, factor: float = 0.0, block_samples: int = 24, averaging_factor: float = 0.98
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def averaging_factor(self) -> float:
        """
        weight of the past, in (0, 1)
        """
    @averaging_factor.setter
    def averaging_factor(self, value: float) -> None: ...
    @property
    def block_samples(self) -> int:
        """
        [sample] length of a block
        """
    @block_samples.setter
    def block_samples(self, value: int) -> None: ...
    @property
    def factor(self) -> float:
        """
        least amplitude over the floor, >= 0; 0: none
        """
    @factor.setter
    def factor(self, value: float) -> None: ...

class NoiseFloor:
    """
    Least threshold, from the quietest part of the scans.
    """
    def __init__(self) -> None: ...
    def configure(self, config: NoiseFloorConfig) -> Status: ...
    def floor(self) -> float:
        """
        [count] rms
        """
    def process(
        self, amplitude: numpy.typing.NDArray[numpy.float32], threshold: numpy.typing.NDArray[numpy.float32]
    ) -> tuple[Status, numpy.typing.NDArray[numpy.float32]]:
        """
        (status, threshold): all (n_samples,); amplitude [count], thresholds [count^2].
        """
    def reset(self) -> None: ...

class ClusterRepresentative:
    """
    What a cluster stands for.

    Members:

      leading_edge

      median
    """

    __members__: typing.ClassVar[dict[str, ClusterRepresentative]]
    leading_edge: typing.ClassVar[ClusterRepresentative]
    median: typing.ClassVar[ClusterRepresentative]
    @typing.overload
    def __eq__(self, other: ClusterRepresentative) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: ClusterRepresentative) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class RangeClusterConfig:
    """
    One-dimensional clustering of decisions.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> RangeClusterConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> RangeClusterConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        merge_distance_s: float = 3.97e-09,
        min_weight: int = 4,
        representative: ClusterRepresentative = ...,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def merge_distance_s(self) -> float:
        """
        [s] closer medians merge
        """
    @merge_distance_s.setter
    def merge_distance_s(self, value: float) -> None: ...
    @property
    def min_weight(self) -> int:
        """
        lighter clusters are dropped, >= 1
        """
    @min_weight.setter
    def min_weight(self, value: int) -> None: ...
    @property
    def representative(self) -> ClusterRepresentative:
        """
        what a cluster stands for
        """
    @representative.setter
    def representative(self, value: ClusterRepresentative) -> None: ...

class RangeClusterer:
    """
    One-dimensional clustering of decisions.
    """
    def __init__(self) -> None: ...
    def configure(
        self, config: RangeClusterConfig, sample_rate_hz: typing.SupportsFloat | typing.SupportsIndex
    ) -> Status: ...
    def process(
        self,
        decisions: numpy.typing.NDArray[numpy.uint8],
        amplitude: numpy.typing.NDArray[numpy.float32],
        threshold: numpy.typing.NDArray[numpy.float32],
    ) -> tuple[Status, numpy.typing.NDArray[numpy.void]]:
        """
        (status, clusters): inputs (n_samples,); clusters is a structured array.
        """

class TimeZero:
    """
    Where delays are counted from.

    Members:

      direct_path : the background's direct path

      recorded : first_sample_s is known
    """

    __members__: typing.ClassVar[dict[str, TimeZero]]
    direct_path: typing.ClassVar[TimeZero]
    recorded: typing.ClassVar[TimeZero]
    @typing.overload
    def __eq__(self, other: TimeZero) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: TimeZero) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class SensorRadarNodeConfig:
    """
    A node of the pipeline sensor_radar.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    alignment: AlignmentConfig
    cfar: CfarConfig
    clutter: ClutterConfig
    direct_path: DirectPathConfig
    envelope: EnvelopeConfig
    noise_floor: NoiseFloorConfig
    pulse_integrator: PulseIntegratorConfig
    range_clusters: RangeClusterConfig
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> SensorRadarNodeConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> SensorRadarNodeConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        node_id: int = 0,
        n_samples: int = 1920,
        sample_rate_hz: float = 16384000000.0,
        first_sample_s: float = 0.0,
        baseline_m: float = 0.0,
        time_zero: TimeZero = ...,
        delay_offset_s: float = 0.0,
        blind_zone_s: float = 1.5e-09,
        pulse_integrator: PulseIntegratorConfig = ...,
        envelope: EnvelopeConfig = ...,
        direct_path: DirectPathConfig = ...,
        alignment: AlignmentConfig = ...,
        clutter: ClutterConfig = ...,
        cfar: CfarConfig = ...,
        noise_floor: NoiseFloorConfig = ...,
        range_clusters: RangeClusterConfig = ...,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def baseline_m(self) -> float:
        """
        [m] transmitter to receiver, 0 if monostatic
        """
    @baseline_m.setter
    def baseline_m(self, value: float) -> None: ...
    @property
    def blind_zone_s(self) -> float:
        """
        [s] after the direct path: not judged, >= 0
        """
    @blind_zone_s.setter
    def blind_zone_s(self, value: float) -> None: ...
    @property
    def delay_offset_s(self) -> float:
        """
        [s] calibration, added to every delay
        """
    @delay_offset_s.setter
    def delay_offset_s(self, value: float) -> None: ...
    @property
    def first_sample_s(self) -> float:
        """
        [s] delay of sample 0, if recorded
        """
    @first_sample_s.setter
    def first_sample_s(self, value: float) -> None: ...
    @property
    def n_samples(self) -> int:
        """
        [sample] of a scan
        """
    @n_samples.setter
    def n_samples(self, value: int) -> None: ...
    @property
    def node_id(self) -> int:
        """
        >= 0
        """
    @node_id.setter
    def node_id(self, value: int) -> None: ...
    @property
    def sample_rate_hz(self) -> float:
        """
        [Hz]
        """
    @sample_rate_hz.setter
    def sample_rate_hz(self, value: float) -> None: ...
    @property
    def time_zero(self) -> TimeZero:
        """
        where delays are counted from
        """
    @time_zero.setter
    def time_zero(self, value: TimeZero) -> None: ...

class SensorRadarNode:
    """
    Raw scans in, delays of echoes from people out.
    """
    def __init__(self) -> None: ...
    def configure(self, config: SensorRadarNodeConfig) -> Status: ...
    def counters(self) -> dict:
        """
        What happened since configure(), by name.
        """
    def process(
        self, scan: numpy.typing.NDArray[numpy.float32], time_us: typing.SupportsInt | typing.SupportsIndex
    ) -> tuple[Status, numpy.typing.NDArray[numpy.void]]:
        """
        (status, detections): what comes in (n_samples,) [count]; detections is structured, delay_s and weight.
        """
    def process_with_taps(
        self, scan: numpy.typing.NDArray[numpy.float32], time_us: typing.SupportsInt | typing.SupportsIndex
    ) -> tuple[Status, numpy.typing.NDArray[numpy.void], dict]:
        """
        (status, detections, taps by name).
        """
    def ready(self) -> bool:
        """
        the background is known
        """
    def report_ready(self) -> bool:
        """
        the last process() completed a scan
        """
    def reset(self) -> None: ...
    def set_empty_room(self, scan: numpy.typing.NDArray[numpy.float32]) -> Status:
        """
        scan (n_samples,) [count] of the empty room, averaged into the background
        """

class TimeZeroConfig:
    """
    Time zero of an M-sequence radar.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> TimeZeroConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> TimeZeroConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        learning_responses: int = 5,
        strong_fraction: float = 0.5,
        least_peak_factor: float = 10.0,
        moved_samples: int = 2,
        moved_responses: int = 3,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def learning_responses(self) -> int:
        """
        whose mean shows the cross-talk, >= 1
        """
    @learning_responses.setter
    def learning_responses(self, value: int) -> None: ...
    @property
    def least_peak_factor(self) -> float:
        """
        largest over mean magnitude, > 1
        """
    @least_peak_factor.setter
    def least_peak_factor(self, value: float) -> None: ...
    @property
    def moved_responses(self) -> int:
        """
        in a row: switched on anew, >= 1
        """
    @moved_responses.setter
    def moved_responses(self, value: int) -> None: ...
    @property
    def moved_samples(self) -> int:
        """
        [sample] farther away, it has moved, >= 0
        """
    @moved_samples.setter
    def moved_samples(self, value: int) -> None: ...
    @property
    def strong_fraction(self) -> float:
        """
        of the largest magnitude, in (0, 1]
        """
    @strong_fraction.setter
    def strong_fraction(self, value: float) -> None: ...

class TimeZeroResult:
    """
    Where a response's cross-talk was.
    """
    @property
    def found(self) -> bool:
        """
        the response is rotated
        """
    @property
    def fraction_samples(self) -> float:
        """
        [sample] behind its own
        """
    @property
    def moved(self) -> bool:
        """
        what was learnt so far is void
        """
    @property
    def rotation_samples(self) -> int:
        """
        [sample] to the left
        """

class TimeZeroFinder:
    """
    Turns responses until the cross-talk stands in its place.
    """
    def __init__(self) -> None: ...
    def configure(
        self,
        config: TimeZeroConfig,
        n_samples: typing.SupportsInt | typing.SupportsIndex,
        expected_samples: typing.SupportsFloat | typing.SupportsIndex,
    ) -> Status: ...
    def process(
        self,
        response: numpy.typing.NDArray[numpy.float32],
        kept_samples: typing.SupportsInt | typing.SupportsIndex = 0,
    ) -> tuple[Status, TimeZeroResult, numpy.typing.NDArray[numpy.float32]]:
        """
        (status, result, rotated): response (n_samples,) [count]; rotated its first kept_samples, 0: all.
        """
    def reset(self) -> None: ...

class WeakSignalConfig:
    """
    Weak-signal enhancement.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> WeakSignalConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> WeakSignalConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self, *, floor_factor: float = 4.0, noise_samples: int = 64, averaging_factor: float = 0.95
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def averaging_factor(self) -> float:
        """
        weight of the past, in [0, 1)
        """
    @averaging_factor.setter
    def averaging_factor(self, value: float) -> None: ...
    @property
    def floor_factor(self) -> float:
        """
        least divisor in deviations of the noise, >= 0
        """
    @floor_factor.setter
    def floor_factor(self, value: float) -> None: ...
    @property
    def noise_samples(self) -> int:
        """
        [sample] at the end of a response, >= 1
        """
    @noise_samples.setter
    def noise_samples(self, value: int) -> None: ...

class WeakSignalEnhancer:
    """
    Raises far echoes to the height of near ones.
    """
    def __init__(self) -> None: ...
    def configure(
        self, config: WeakSignalConfig, n_samples: typing.SupportsInt | typing.SupportsIndex
    ) -> Status: ...
    def noise(self) -> float:
        """
        [count] rms
        """
    def process(
        self, samples: numpy.typing.NDArray[numpy.float32]
    ) -> tuple[Status, numpy.typing.NDArray[numpy.float32]]:
        """
        (status, enhanced): both (n_samples,), the latter in [-1, 1].
        """
    def reset(self) -> None: ...

class ClutterSpread:
    """
    What the slow spread is about.

    Members:

      standard_deviation : the slow mean

      rms : 0
    """

    __members__: typing.ClassVar[dict[str, ClutterSpread]]
    rms: typing.ClassVar[ClutterSpread]
    standard_deviation: typing.ClassVar[ClutterSpread]
    @typing.overload
    def __eq__(self, other: ClutterSpread) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: ClutterSpread) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class GaussianCfarConfig:
    """
    CFAR for Gaussian clutter.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> GaussianCfarConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> GaussianCfarConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        fast_factor: float = 0.3,
        slow_factor: float = 0.01,
        deviations: float = 0.7,
        spread: ClutterSpread = ...,
        starting_samples: int = 200,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def deviations(self) -> float:
        """
        of the fast mean above the slow one, > 0
        """
    @deviations.setter
    def deviations(self, value: float) -> None: ...
    @property
    def fast_factor(self) -> float:
        """
        weight of a sample, in (0, 1]
        """
    @fast_factor.setter
    def fast_factor(self, value: float) -> None: ...
    @property
    def slow_factor(self) -> float:
        """
        weight of a sample, in (0, 1]
        """
    @slow_factor.setter
    def slow_factor(self, value: float) -> None: ...
    @property
    def spread(self) -> ClutterSpread:
        """
        what the slow spread is about
        """
    @spread.setter
    def spread(self, value: ClutterSpread) -> None: ...
    @property
    def starting_samples(self) -> int:
        """
        [sample] of the run-in, >= 1
        """
    @starting_samples.setter
    def starting_samples(self, value: int) -> None: ...

class GaussianCfarDetector:
    """
    Decides along one response.
    """
    def __init__(self) -> None: ...
    def configure(self, config: GaussianCfarConfig) -> Status: ...
    def delay_samples(self) -> float:
        """
        [sample] by which the fast mean is late
        """
    def process(
        self, samples: numpy.typing.NDArray[numpy.float32]
    ) -> tuple[Status, numpy.typing.NDArray[numpy.uint8]]:
        """
        (status, decisions): both (n_samples,), the latter 0 or 1.
        """

class TargetTraceConfig:
    """
    Simple targets for distributed ones.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> TargetTraceConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> TargetTraceConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self, *, window_samples: int = 15, least_hits: int = 5, density_correction: bool = False
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def density_correction(self) -> bool:
        """
        for what missing hits delay
        """
    @density_correction.setter
    def density_correction(self, value: bool) -> None: ...
    @property
    def least_hits(self) -> int:
        """
        in the window, 1 to window_samples
        """
    @least_hits.setter
    def least_hits(self, value: int) -> None: ...
    @property
    def window_samples(self) -> int:
        """
        [sample] a person's extent, >= 1
        """
    @window_samples.setter
    def window_samples(self, value: int) -> None: ...

class TargetTracer:
    """
    Where targets begin.
    """
    def __init__(self) -> None: ...
    def configure(self, config: TargetTraceConfig) -> Status: ...
    def process(
        self, decisions: numpy.typing.NDArray[numpy.uint8]
    ) -> tuple[Status, numpy.typing.NDArray[numpy.void]]:
        """
        (status, traces): decisions (n_samples,); traces is structured.
        """

class EdgeRule:
    """
    What the beginning of an echo is.

    Members:

      fraction : where the envelope first exceeds a fraction of its largest value

      contrast : where its mean behind exceeds that before it the most
    """

    __members__: typing.ClassVar[dict[str, EdgeRule]]
    contrast: typing.ClassVar[EdgeRule]
    fraction: typing.ClassVar[EdgeRule]
    @typing.overload
    def __eq__(self, other: EdgeRule) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: EdgeRule) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class LeadingEdgeConfig:
    """
    Where an echo begins.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> LeadingEdgeConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> LeadingEdgeConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        rule: EdgeRule = ...,
        fraction: float = 0.5,
        mean_samples: int = 10,
        before_samples: int = 4,
        after_samples: int = 13,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def after_samples(self) -> int:
        """
        [sample] of the window, 0 to 1000
        """
    @after_samples.setter
    def after_samples(self, value: int) -> None: ...
    @property
    def before_samples(self) -> int:
        """
        [sample] of the window, 0 to 1000
        """
    @before_samples.setter
    def before_samples(self, value: int) -> None: ...
    @property
    def fraction(self) -> float:
        """
        fraction: of the window's largest envelope, in (0, 1)
        """
    @fraction.setter
    def fraction(self, value: float) -> None: ...
    @property
    def mean_samples(self) -> int:
        """
        [sample] contrast: of either mean, 1 to 1000
        """
    @mean_samples.setter
    def mean_samples(self, value: int) -> None: ...
    @property
    def rule(self) -> EdgeRule:
        """
        what the beginning of an echo is
        """
    @rule.setter
    def rule(self, value: EdgeRule) -> None: ...

class LeadingEdge:
    """
    Moves traces to the beginning of their echoes.
    """
    def __init__(self) -> None: ...
    def configure(self, config: LeadingEdgeConfig) -> Status: ...
    def process(
        self, envelope: numpy.typing.NDArray[numpy.float32], traces: numpy.typing.NDArray[numpy.void]
    ) -> tuple[Status, numpy.typing.NDArray[numpy.void]]:
        """
        (status, traces): envelope (n_samples,) [count]; traces as of TargetTracer.
        """

class ThroughWallNodeConfig:
    """
    A receiver of the pipeline through_wall_2d.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    clutter: ClutterConfig
    envelope: EnvelopeConfig
    gaussian_cfar: GaussianCfarConfig
    leading_edge: LeadingEdgeConfig
    target_traces: TargetTraceConfig
    time_zero: TimeZeroConfig
    weak_signal: WeakSignalConfig
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> ThroughWallNodeConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> ThroughWallNodeConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        node_id: int = 0,
        n_samples: int = 511,
        kept_samples: int = 0,
        sample_rate_hz: float = 4500000000.0,
        baseline_m: float = 0.4,
        delay_offset_s: float = 0.0,
        blind_zone_s: float = 2.7e-09,
        max_delay_s: float = 0.0,
        full_scale_count: float = 0.0,
        saturated_samples: int = 2,
        time_zero: TimeZeroConfig = ...,
        clutter: ClutterConfig = ...,
        envelope: EnvelopeConfig = ...,
        weak_signal: WeakSignalConfig = ...,
        gaussian_cfar: GaussianCfarConfig = ...,
        target_traces: TargetTraceConfig = ...,
        leading_edge: LeadingEdgeConfig = ...,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def baseline_m(self) -> float:
        """
        [m] transmitter to receiver
        """
    @baseline_m.setter
    def baseline_m(self, value: float) -> None: ...
    @property
    def blind_zone_s(self) -> float:
        """
        [s] after the cross-talk's delay: not reported, >= 0
        """
    @blind_zone_s.setter
    def blind_zone_s(self, value: float) -> None: ...
    @property
    def delay_offset_s(self) -> float:
        """
        [s] calibration, added to every delay
        """
    @delay_offset_s.setter
    def delay_offset_s(self, value: float) -> None: ...
    @property
    def full_scale_count(self) -> float:
        """
        [count] of a saturated sample; 0: not known
        """
    @full_scale_count.setter
    def full_scale_count(self, value: float) -> None: ...
    @property
    def kept_samples(self) -> int:
        """
        [sample] of it once turned, past blind_zone_s and noise_samples, at most 1920; 0: all
        """
    @kept_samples.setter
    def kept_samples(self, value: int) -> None: ...
    @property
    def max_delay_s(self) -> float:
        """
        [s] what begins later is not reported; 0: all is
        """
    @max_delay_s.setter
    def max_delay_s(self, value: float) -> None: ...
    @property
    def n_samples(self) -> int:
        """
        [sample] of a response
        """
    @n_samples.setter
    def n_samples(self, value: int) -> None: ...
    @property
    def node_id(self) -> int:
        """
        >= 0
        """
    @node_id.setter
    def node_id(self, value: int) -> None: ...
    @property
    def sample_rate_hz(self) -> float:
        """
        [Hz] the sequence's clock
        """
    @sample_rate_hz.setter
    def sample_rate_hz(self, value: float) -> None: ...
    @property
    def saturated_samples(self) -> int:
        """
        [sample] of a trusted response, >= 0
        """
    @saturated_samples.setter
    def saturated_samples(self, value: int) -> None: ...

class ThroughWallNode:
    """
    One receiver's responses in, delays of echoes from people out.
    """
    def __init__(self) -> None: ...
    def configure(self, config: ThroughWallNodeConfig) -> Status: ...
    def counters(self) -> dict:
        """
        What happened since configure(), by name.
        """
    def process(
        self,
        response: numpy.typing.NDArray[numpy.float32],
        time_us: typing.SupportsInt | typing.SupportsIndex,
    ) -> tuple[Status, numpy.typing.NDArray[numpy.void]]:
        """
        (status, detections): what comes in (n_samples,) [count]; detections is structured, delay_s and weight.
        """
    def process_with_taps(
        self,
        response: numpy.typing.NDArray[numpy.float32],
        time_us: typing.SupportsInt | typing.SupportsIndex,
    ) -> tuple[Status, numpy.typing.NDArray[numpy.void], dict]:
        """
        (status, detections, taps by name).
        """
    def ready(self) -> bool:
        """
        time zero and background are known
        """
    def report_ready(self) -> bool:
        """
        the last process() gave a report
        """
    def reset(self) -> None: ...

class Point:
    """
    A position in the plane.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> Point: ...
    def __deepcopy__(self, memo: typing.Any) -> Point: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(self, *, x_m: float = 0.0, y_m: float = 0.0) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def x_m(self) -> float:
        """
        [m]
        """
    @x_m.setter
    def x_m(self, value: float) -> None: ...
    @property
    def y_m(self) -> float:
        """
        [m]
        """
    @y_m.setter
    def y_m(self, value: float) -> None: ...

class Area:
    """
    A rectangle along the axes, edges included.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> Area: ...
    def __deepcopy__(self, memo: typing.Any) -> Area: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self, *, min_x_m: float = 0.0, min_y_m: float = 0.0, max_x_m: float = 0.0, max_y_m: float = 0.0
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def max_x_m(self) -> float:
        """
        [m]
        """
    @max_x_m.setter
    def max_x_m(self, value: float) -> None: ...
    @property
    def max_y_m(self) -> float:
        """
        [m]
        """
    @max_y_m.setter
    def max_y_m(self, value: float) -> None: ...
    @property
    def min_x_m(self) -> float:
        """
        [m]
        """
    @min_x_m.setter
    def min_x_m(self, value: float) -> None: ...
    @property
    def min_y_m(self) -> float:
        """
        [m]
        """
    @min_y_m.setter
    def min_y_m(self, value: float) -> None: ...

class NodeSite:
    """
    The foci of one node's ellipses; monostatic when both are in one place.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    node_id: int
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> NodeSite: ...
    def __deepcopy__(self, memo: typing.Any) -> NodeSite: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(self, *, node_id: int = 0, tx: Point = ..., rx: Point = ...) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def rx(self) -> Point:
        """
        [m]
        """
    @rx.setter
    def rx(self, value: Point) -> None: ...
    @property
    def tx(self) -> Point:
        """
        [m]
        """
    @tx.setter
    def tx(self, value: Point) -> None: ...

class EllipseRefinement:
    """
    Members:

      gauss_newton

      none
    """

    __members__: typing.ClassVar[dict[str, EllipseRefinement]]
    gauss_newton: typing.ClassVar[EllipseRefinement]
    none: typing.ClassVar[EllipseRefinement]
    @typing.overload
    def __eq__(self, other: EllipseRefinement) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: EllipseRefinement) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class EllipseConfig:
    """
    Intersection of ellipses (eqs. 16-23).
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    refinement: EllipseRefinement
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> EllipseConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> EllipseConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        refinement: EllipseRefinement = ...,
        max_iterations: int = 10,
        max_step_m: float = 1.0,
        body_radius_m: float = 0.0,
        robust_scale_m: float = 0.15,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def body_radius_m(self) -> float:
        """
        [m]
        """
    @body_radius_m.setter
    def body_radius_m(self, value: float) -> None: ...
    @property
    def max_iterations(self) -> int:
        """
        of Gauss-Newton
        """
    @max_iterations.setter
    def max_iterations(self, value: int) -> None: ...
    @property
    def max_step_m(self) -> float:
        """
        [m]
        """
    @max_step_m.setter
    def max_step_m(self, value: float) -> None: ...
    @property
    def robust_scale_m(self) -> float:
        """
        [m] 0: all paths alike
        """
    @robust_scale_m.setter
    def robust_scale_m(self, value: float) -> None: ...

class EllipseFix:
    @property
    def converged(self) -> bool: ...
    @property
    def equation_residual_m3(self) -> float: ...
    @property
    def iterations(self) -> int: ...
    @property
    def position_m(self) -> tuple[float, float]: ...
    @property
    def range_residual_m(self) -> float: ...

class EllipseLeastSquares:
    def __init__(self) -> None: ...
    def configure(self, config: EllipseConfig) -> Status: ...
    def process(
        self,
        nodes: collections.abc.Sequence[NodeSite],
        path_m: numpy.typing.NDArray[numpy.float32],
        weight: numpy.typing.NDArray[numpy.float32],
        area: Area,
    ) -> tuple[Status, EllipseFix]:
        """
        (status, EllipseFix) from one path a node.
        """
    def refine(
        self,
        nodes: collections.abc.Sequence[NodeSite],
        path_m: numpy.typing.NDArray[numpy.float32],
        weight: numpy.typing.NDArray[numpy.float32],
        position: Point,
        robust: bool,
    ) -> tuple[Status, EllipseFix]:
        """
        (status, EllipseFix) by Gauss-Newton from a position.
        """

class CoverageConfig:
    """
    Link budget of a site (section III).
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    antenna_gain_db: float
    bandwidth_hz: float
    blind_zone_s: float
    body_radius_m: float
    centre_hz: float
    excess_path_loss_1m_db: float
    frequency_exponent: float
    min_snr_db: float
    noise_figure_db: float
    noise_temperature_K: float
    path_loss_exponent: float
    path_sigma_m: float
    pulse_interval_s: float
    pulses_per_scan: int
    radar_cross_section_m2: float
    transmit_power_dbm: float
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> CoverageConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> CoverageConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        transmit_power_dbm: float = -12.64,
        noise_figure_db: float = 4.8,
        antenna_gain_db: float = 0.0,
        centre_hz: float = 4300000000.0,
        bandwidth_hz: float = 2200000000.0,
        pulse_interval_s: float = 1.1712e-07,
        pulses_per_scan: int = 20480,
        radar_cross_section_m2: float = 1.0,
        noise_temperature_K: float = 290.0,
        path_loss_exponent: float = 2.0,
        frequency_exponent: float = 0.0,
        excess_path_loss_1m_db: float = 0.0,
        min_snr_db: float = 20.0,
        blind_zone_s: float = 1.5e-09,
        path_sigma_m: float = 0.05,
        body_radius_m: float = 0.0,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """

class Coverage:
    def __init__(self) -> None: ...
    def configure(
        self, config: CoverageConfig, nodes: collections.abc.Sequence[NodeSite], area: Area
    ) -> Status: ...
    def process(
        self, positions_m: numpy.typing.NDArray[numpy.float32]
    ) -> tuple[Status, numpy.typing.NDArray[numpy.void]]:
        """
        (status, structured array of CoveragePoint) of places (n, 2).
        """
    @property
    def bistatic_constant(self) -> float: ...

class PairingRule:
    """
    Members:

      assignment

      all_pairs
    """

    __members__: typing.ClassVar[dict[str, PairingRule]]
    all_pairs: typing.ClassVar[PairingRule]
    assignment: typing.ClassVar[PairingRule]
    @typing.overload
    def __eq__(self, other: PairingRule) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: PairingRule) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class ClosingRule:
    """
    Members:

      exact

      printed
    """

    __members__: typing.ClassVar[dict[str, ClosingRule]]
    exact: typing.ClassVar[ClosingRule]
    printed: typing.ClassVar[ClosingRule]
    @typing.overload
    def __eq__(self, other: ClosingRule) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: ClosingRule) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class TracePairingConfig:
    """
    Couples of two receivers' traces.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    closing: ClosingRule
    rule: PairingRule
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> TracePairingConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> TracePairingConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        rule: PairingRule = ...,
        closing: ClosingRule = ...,
        separation_m: float = 0.8,
        clock_hz: float = 4500000000.0,
        correction_samples: int = 1,
        completion_limit: int = 3,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def clock_hz(self) -> float:
        """
        [Hz]
        """
    @clock_hz.setter
    def clock_hz(self, value: float) -> None: ...
    @property
    def completion_limit(self) -> int:
        """
        responses
        """
    @completion_limit.setter
    def completion_limit(self, value: int) -> None: ...
    @property
    def correction_samples(self) -> int:
        """
        [sample]
        """
    @correction_samples.setter
    def correction_samples(self, value: int) -> None: ...
    @property
    def separation_m(self) -> float:
        """
        [m] between the receivers
        """
    @separation_m.setter
    def separation_m(self, value: float) -> None: ...

class TracePairing:
    def __init__(self) -> None: ...
    def configure(self, config: TracePairingConfig) -> Status: ...
    def process(
        self, delay1_s: numpy.typing.NDArray[numpy.float32], delay2_s: numpy.typing.NDArray[numpy.float32]
    ) -> tuple[Status, numpy.typing.NDArray[numpy.void]]:
        """
        (status, structured array of TraceCouple).
        """
    def reset(self) -> None: ...

class WallCompensation:
    """
    Members:

      none

      first_kind

      second_kind
    """

    __members__: typing.ClassVar[dict[str, WallCompensation]]
    first_kind: typing.ClassVar[WallCompensation]
    none: typing.ClassVar[WallCompensation]
    second_kind: typing.ClassVar[WallCompensation]
    @typing.overload
    def __eq__(self, other: WallCompensation) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: WallCompensation) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class WallConfig:
    """
    A homogeneous slab.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    compensation: WallCompensation
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> WallConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> WallConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        thickness_m: float = 0.24,
        relative_permittivity: float = 4.0,
        compensation: WallCompensation = ...,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def relative_permittivity(self) -> float:
        """
        [1]
        """
    @relative_permittivity.setter
    def relative_permittivity(self, value: float) -> None: ...
    @property
    def thickness_m(self) -> float:
        """
        [m]
        """
    @thickness_m.setter
    def thickness_m(self, value: float) -> None: ...

class Wall:
    def __init__(self) -> None: ...
    def configure(self, config: WallConfig) -> Status: ...
    def ray(
        self,
        lateral_m: typing.SupportsFloat | typing.SupportsIndex,
        depth_m: typing.SupportsFloat | typing.SupportsIndex,
    ) -> tuple[float, float, float]:
        """
        (excess [m], gradient of the optical path along the wall, and across it), one way.
        """

class LineFixStatus:
    """
    Members:

      fix

      no_intersection

      too_near_axis

      singular
    """

    __members__: typing.ClassVar[dict[str, LineFixStatus]]
    fix: typing.ClassVar[LineFixStatus]
    no_intersection: typing.ClassVar[LineFixStatus]
    singular: typing.ClassVar[LineFixStatus]
    too_near_axis: typing.ClassVar[LineFixStatus]
    @typing.overload
    def __eq__(self, other: LineFixStatus) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: LineFixStatus) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class LineLocatorConfig:
    """
    Position before a line of antennas.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    wall: WallConfig
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> LineLocatorConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> LineLocatorConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(self, *, wall: WallConfig = ..., path_std_m: float = 0.033) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def path_std_m(self) -> float:
        """
        [m]
        """
    @path_std_m.setter
    def path_std_m(self, value: float) -> None: ...

class LineFix:
    @property
    def converged(self) -> bool: ...
    @property
    def covariance_m2(self) -> tuple[float, float, float]:
        """
        (xx, xy, yy) [m^2]
        """
    @property
    def iterations(self) -> int: ...
    @property
    def position_m(self) -> tuple[float, float]: ...
    @property
    def status(self) -> LineFixStatus: ...

class LineLocator:
    def __init__(self) -> None: ...
    def configure(self, config: LineLocatorConfig, rx_x_m: numpy.typing.NDArray[numpy.float32]) -> Status: ...
    def process(
        self, path_m: numpy.typing.NDArray[numpy.float32], weight: numpy.typing.NDArray[numpy.float32]
    ) -> tuple[Status, LineFix]:
        """
        (status, LineFix).
        """

class Planar3dMethod:
    """
    Members:

      three_d_two_d

      approximate
    """

    __members__: typing.ClassVar[dict[str, Planar3dMethod]]
    approximate: typing.ClassVar[Planar3dMethod]
    three_d_two_d: typing.ClassVar[Planar3dMethod]
    @typing.overload
    def __eq__(self, other: Planar3dMethod) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: Planar3dMethod) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class Planar3dStatus:
    """
    Members:

      fix

      clipped

      bad_path
    """

    __members__: typing.ClassVar[dict[str, Planar3dStatus]]
    bad_path: typing.ClassVar[Planar3dStatus]
    clipped: typing.ClassVar[Planar3dStatus]
    fix: typing.ClassVar[Planar3dStatus]
    @typing.overload
    def __eq__(self, other: Planar3dStatus) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: Planar3dStatus) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class Planar3dFix:
    @property
    def position_m(self) -> tuple: ...
    @property
    def status(self) -> Planar3dStatus: ...

class Taylor3dStart:
    """
    Members:

      three_d_two_d

      approximate

      given
    """

    __members__: typing.ClassVar[dict[str, Taylor3dStart]]
    approximate: typing.ClassVar[Taylor3dStart]
    given: typing.ClassVar[Taylor3dStart]
    three_d_two_d: typing.ClassVar[Taylor3dStart]
    @typing.overload
    def __eq__(self, other: Taylor3dStart) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: Taylor3dStart) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class RangeKind:
    """
    Members:

      bistatic

      one_way
    """

    __members__: typing.ClassVar[dict[str, RangeKind]]
    bistatic: typing.ClassVar[RangeKind]
    one_way: typing.ClassVar[RangeKind]
    @typing.overload
    def __eq__(self, other: RangeKind) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: RangeKind) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class Taylor3dStatus:
    """
    Members:

      converged

      diverging

      iteration_limit

      singular

      no_start
    """

    __members__: typing.ClassVar[dict[str, Taylor3dStatus]]
    converged: typing.ClassVar[Taylor3dStatus]
    diverging: typing.ClassVar[Taylor3dStatus]
    iteration_limit: typing.ClassVar[Taylor3dStatus]
    no_start: typing.ClassVar[Taylor3dStatus]
    singular: typing.ClassVar[Taylor3dStatus]
    @typing.overload
    def __eq__(self, other: Taylor3dStatus) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: Taylor3dStatus) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class Taylor3dConfig:
    """
    Position in space by the Taylor-series method.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    max_iterations: int
    range_kind: RangeKind
    start: Taylor3dStart
    wall: WallConfig
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> Taylor3dConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> Taylor3dConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        wall: WallConfig = ...,
        start: Taylor3dStart = ...,
        range_kind: RangeKind = ...,
        min_step_m: float = 0.0001,
        max_iterations: int = 20,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def min_step_m(self) -> float:
        """
        [m]
        """
    @min_step_m.setter
    def min_step_m(self, value: float) -> None: ...

class Taylor3dFix:
    @property
    def clipped_start(self) -> bool: ...
    @property
    def covariance_m2(self) -> tuple:
        """
        (xx, xy, xz, yy, yz, zz) [m^2]
        """
    @property
    def iterations(self) -> int: ...
    @property
    def position_m(self) -> tuple: ...
    @property
    def range_residual_m(self) -> float: ...
    @property
    def status(self) -> Taylor3dStatus: ...

class Taylor3d:
    def __init__(self) -> None: ...
    def configure(
        self,
        config: Taylor3dConfig,
        tx_m: numpy.typing.NDArray[numpy.float32],
        rx_m: numpy.typing.NDArray[numpy.float32],
    ) -> Status:
        """
        tx_m (3,), rx_m (n, 3) [m].
        """
    def process(
        self,
        range_m: numpy.typing.NDArray[numpy.float32],
        variance_m2: numpy.typing.NDArray[numpy.float32],
        given_m: numpy.typing.NDArray[numpy.float32],
    ) -> tuple[Status, Taylor3dFix]:
        """
        (status, Taylor3dFix); given_m (3,) [m] counts only if the start is given.
        """

class FrameAssemblerConfig:
    """
    Lines up the nodes' reports.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    dead_after_frames: int
    resync_after_reports: int
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> FrameAssemblerConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> FrameAssemblerConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        deadline_us: int = 80000,
        dead_after_frames: int = 10,
        resync_after_reports: int = 3,
        max_delay_s: float = 1e-06,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def deadline_us(self) -> int:
        """
        [us]
        """
    @deadline_us.setter
    def deadline_us(self, value: int) -> None: ...
    @property
    def max_delay_s(self) -> float:
        """
        [s]
        """
    @max_delay_s.setter
    def max_delay_s(self, value: float) -> None: ...

class FrameAssemblerCounters:
    @property
    def absent(self) -> int: ...
    @property
    def accepted(self) -> int: ...
    @property
    def doubled(self) -> int: ...
    @property
    def early(self) -> int: ...
    @property
    def frames(self) -> int: ...
    @property
    def late(self) -> int: ...
    @property
    def lost(self) -> int: ...
    @property
    def malformed(self) -> int: ...
    @property
    def resynchronised(self) -> int: ...
    @property
    def slow(self) -> int: ...
    @property
    def unknown_node(self) -> int: ...

class FrameAssembler:
    def __init__(self) -> None: ...
    def configure(
        self, config: FrameAssemblerConfig, nodes: collections.abc.Sequence[NodeSite]
    ) -> Status: ...
    def poll(self, now_us: typing.SupportsInt | typing.SupportsIndex) -> tuple:
        """
        (status, None or (time_us, frame, n_reported, structured array of FrameDetection)).
        """
    def receive(
        self,
        node_id: typing.SupportsInt | typing.SupportsIndex,
        frame: typing.SupportsInt | typing.SupportsIndex,
        delay_s: numpy.typing.NDArray[numpy.float32],
        weight: numpy.typing.NDArray[numpy.float32],
        now_us: typing.SupportsInt | typing.SupportsIndex,
        time_us: typing.SupportsInt | typing.SupportsIndex = 0,
    ) -> Status: ...
    def reset(self) -> None: ...
    @property
    def counters(self) -> FrameAssemblerCounters: ...

class SelectionMethod:
    """
    Members:

      consensus

      all_tuples
    """

    __members__: typing.ClassVar[dict[str, SelectionMethod]]
    all_tuples: typing.ClassVar[SelectionMethod]
    consensus: typing.ClassVar[SelectionMethod]
    @typing.overload
    def __eq__(self, other: SelectionMethod) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: SelectionMethod) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class SelectionResidual:
    """
    Members:

      range_residual

      equation_residual
    """

    __members__: typing.ClassVar[dict[str, SelectionResidual]]
    equation_residual: typing.ClassVar[SelectionResidual]
    range_residual: typing.ClassVar[SelectionResidual]
    @typing.overload
    def __eq__(self, other: SelectionResidual) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: SelectionResidual) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class SelectionConfig:
    """
    Positions from a frame's detections.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    method: SelectionMethod
    residual: SelectionResidual
    track_aided: bool
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> SelectionConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> SelectionConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        method: SelectionMethod = ...,
        residual: SelectionResidual = ...,
        nodes_per_tuple: int = 3,
        min_weight: float = 0.0,
        max_range_residual_m: float = 0.25,
        max_equation_residual_m3: float = 6e-13,
        coarse_residual_m: float = 1.0,
        support_gate_m: float = 0.3,
        min_support: int = 3,
        min_support_fraction: float = 0.6,
        min_own_support: int = 3,
        echo_tail_m: float = 0.0,
        track_aided: bool = True,
        track_gate_m: float = 0.6,
        track_min_support: int = 3,
        track_min_own_support: int = 2,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def coarse_residual_m(self) -> float:
        """
        [m]
        """
    @coarse_residual_m.setter
    def coarse_residual_m(self, value: float) -> None: ...
    @property
    def echo_tail_m(self) -> float:
        """
        [m]
        """
    @echo_tail_m.setter
    def echo_tail_m(self, value: float) -> None: ...
    @property
    def max_equation_residual_m3(self) -> float:
        """
        [m^3]
        """
    @max_equation_residual_m3.setter
    def max_equation_residual_m3(self, value: float) -> None: ...
    @property
    def max_range_residual_m(self) -> float:
        """
        [m]
        """
    @max_range_residual_m.setter
    def max_range_residual_m(self, value: float) -> None: ...
    @property
    def min_own_support(self) -> int:
        """
        nodes
        """
    @min_own_support.setter
    def min_own_support(self, value: int) -> None: ...
    @property
    def min_support(self) -> int:
        """
        nodes
        """
    @min_support.setter
    def min_support(self, value: int) -> None: ...
    @property
    def min_support_fraction(self) -> float:
        """
        of the nodes that reported
        """
    @min_support_fraction.setter
    def min_support_fraction(self, value: float) -> None: ...
    @property
    def min_weight(self) -> float:
        """
        [1]
        """
    @min_weight.setter
    def min_weight(self, value: float) -> None: ...
    @property
    def nodes_per_tuple(self) -> int:
        """
        nu
        """
    @nodes_per_tuple.setter
    def nodes_per_tuple(self, value: int) -> None: ...
    @property
    def support_gate_m(self) -> float:
        """
        [m]
        """
    @support_gate_m.setter
    def support_gate_m(self, value: float) -> None: ...
    @property
    def track_gate_m(self) -> float:
        """
        [m]
        """
    @track_gate_m.setter
    def track_gate_m(self, value: float) -> None: ...
    @property
    def track_min_own_support(self) -> int:
        """
        nodes
        """
    @track_min_own_support.setter
    def track_min_own_support(self, value: int) -> None: ...
    @property
    def track_min_support(self) -> int:
        """
        nodes
        """
    @track_min_support.setter
    def track_min_support(self, value: int) -> None: ...

class SelectionCounters:
    @property
    def dropped_detections(self) -> int: ...
    @property
    def dropped_measurements(self) -> int: ...
    @property
    def dropped_tuples(self) -> int: ...
    @property
    def frames(self) -> int: ...
    @property
    def tuples(self) -> int: ...

class MeasurementSelection:
    def __init__(self) -> None: ...
    def configure(
        self,
        config: SelectionConfig,
        ellipse: EllipseConfig,
        nodes: collections.abc.Sequence[NodeSite],
        area: Area,
    ) -> Status: ...
    def process(
        self,
        node_index: numpy.typing.NDArray[numpy.int32],
        path_m: numpy.typing.NDArray[numpy.float32],
        weight: numpy.typing.NDArray[numpy.float32],
        n_reported: typing.SupportsInt | typing.SupportsIndex,
        predictions_m: numpy.typing.NDArray[numpy.float32],
    ) -> tuple[Status, numpy.typing.NDArray[numpy.void]]:
        """
        (status, structured array of Measurement) of one frame; predictions_m (p, 2).
        """
    def reset(self) -> None: ...
    @property
    def counters(self) -> SelectionCounters: ...

class ClusterDistance:
    """
    Members:

      centroid

      minimum

      maximum
    """

    __members__: typing.ClassVar[dict[str, ClusterDistance]]
    centroid: typing.ClassVar[ClusterDistance]
    maximum: typing.ClassVar[ClusterDistance]
    minimum: typing.ClassVar[ClusterDistance]
    @typing.overload
    def __eq__(self, other: ClusterDistance) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: ClusterDistance) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class PointClusterConfig:
    """
    Hierarchical clustering (Algorithm 2, mended).
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    distance: ClusterDistance
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> PointClusterConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> PointClusterConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(self, *, distance: ClusterDistance = ..., threshold_m: float = 0.8) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def threshold_m(self) -> float:
        """
        [m]
        """
    @threshold_m.setter
    def threshold_m(self, value: float) -> None: ...

class PointClusters:
    def __init__(self) -> None: ...
    def configure(self, config: PointClusterConfig) -> Status: ...
    def process(
        self, position_m: numpy.typing.NDArray[numpy.float32], weight: numpy.typing.NDArray[numpy.float32]
    ) -> tuple[Status, numpy.typing.NDArray[numpy.void]]:
        """
        (status, structured array of PointCluster) of positions (n, 2).
        """
    @property
    def dropped(self) -> int: ...

class ResamplingChance:
    """
    In proportion to what particles are drawn.

    Members:

      square_root

      proportional
    """

    __members__: typing.ClassVar[dict[str, ResamplingChance]]
    proportional: typing.ClassVar[ResamplingChance]
    square_root: typing.ClassVar[ResamplingChance]
    @typing.overload
    def __eq__(self, other: ResamplingChance) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: ResamplingChance) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class PhdConfig:
    """
    Particle PHD filter with measurement-driven birth.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    mass_average_frames: int
    newborn_per_measurement: int
    particles_per_target: int
    resampling: ResamplingChance
    seed: int
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> PhdConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> PhdConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        detection_probability: float = 0.9,
        survival_probability: float = 0.99,
        clutter_per_frame: float = 2.0,
        birth_per_frame: float = 0.02,
        area_m2: float = 69.0,
        measurement_std_m: float = 0.3,
        acceleration_density_m2ps3: float = 0.1,
        newborn_velocity_std_mps: float = 1.2,
        particles_per_target: int = 1000,
        newborn_per_measurement: int = 64,
        mass_average_frames: int = 1,
        resampling: ResamplingChance = ...,
        seed: int = 1,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def acceleration_density_m2ps3(self) -> float:
        """
        [m^2/s^3]
        """
    @acceleration_density_m2ps3.setter
    def acceleration_density_m2ps3(self, value: float) -> None: ...
    @property
    def area_m2(self) -> float:
        """
        [m^2]
        """
    @area_m2.setter
    def area_m2(self, value: float) -> None: ...
    @property
    def birth_per_frame(self) -> float:
        """
        expected, uniform over the area
        """
    @birth_per_frame.setter
    def birth_per_frame(self, value: float) -> None: ...
    @property
    def clutter_per_frame(self) -> float:
        """
        expected, uniform over the area
        """
    @clutter_per_frame.setter
    def clutter_per_frame(self, value: float) -> None: ...
    @property
    def detection_probability(self) -> float:
        """
        per frame
        """
    @detection_probability.setter
    def detection_probability(self, value: float) -> None: ...
    @property
    def measurement_std_m(self) -> float:
        """
        [m] per coordinate
        """
    @measurement_std_m.setter
    def measurement_std_m(self, value: float) -> None: ...
    @property
    def newborn_velocity_std_mps(self) -> float:
        """
        [m/s] per coordinate
        """
    @newborn_velocity_std_mps.setter
    def newborn_velocity_std_mps(self, value: float) -> None: ...
    @property
    def survival_probability(self) -> float:
        """
        per frame
        """
    @survival_probability.setter
    def survival_probability(self, value: float) -> None: ...

class PhdFilter:
    """
    A frame is predict, update, resample.
    """
    def __init__(self) -> None: ...
    def configure(self, config: PhdConfig) -> Status: ...
    def predict(self, dt_s: typing.SupportsFloat | typing.SupportsIndex) -> Status: ...
    def resample(self) -> Status: ...
    def reset(self) -> None: ...
    def update(self, measurements: numpy.typing.NDArray[numpy.float32]) -> Status:
        """
        measurements (m, 2) [m]
        """
    @property
    def mass(self) -> float: ...
    @property
    def measurement_mass(self) -> numpy.typing.NDArray[numpy.float32]: ...
    @property
    def number(self) -> int: ...
    @property
    def particles(self) -> numpy.typing.NDArray[numpy.float32]: ...
    @property
    def peak_seed(self) -> int: ...
    @property
    def persistent(self) -> numpy.typing.NDArray[numpy.float32]: ...

class TrackState:
    """
    Members:

      unconfirmed

      confirmed

      silent

      dead
    """

    __members__: typing.ClassVar[dict[str, TrackState]]
    confirmed: typing.ClassVar[TrackState]
    dead: typing.ClassVar[TrackState]
    silent: typing.ClassVar[TrackState]
    unconfirmed: typing.ClassVar[TrackState]
    @typing.overload
    def __eq__(self, other: TrackState) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: TrackState) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class AssociationRule:
    """
    Which pairs of track and point hold.

    Members:

      per_pair

      hypothesis_cost
    """

    __members__: typing.ClassVar[dict[str, AssociationRule]]
    hypothesis_cost: typing.ClassVar[AssociationRule]
    per_pair: typing.ClassVar[AssociationRule]
    @typing.overload
    def __eq__(self, other: AssociationRule) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: AssociationRule) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class TrackUpdate:
    """
    What a point does to its track.

    Members:

      estimate

      kalman
    """

    __members__: typing.ClassVar[dict[str, TrackUpdate]]
    estimate: typing.ClassVar[TrackUpdate]
    kalman: typing.ClassVar[TrackUpdate]
    @typing.overload
    def __eq__(self, other: TrackUpdate) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: TrackUpdate) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class TrackManagerConfig:
    """
    Association, life and motion of tracks.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    association: AssociationRule
    silent_time_per_confirmed: float
    update: TrackUpdate
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> TrackManagerConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> TrackManagerConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        association: AssociationRule = ...,
        update: TrackUpdate = ...,
        gate_m: float = 1.0,
        cost_max_m: float = 1.0,
        gate_sigma: float = 4.0,
        silent_gate_growth_mps: float = 0.2,
        silent_gate_max_m: float = 1.5,
        birth_exclusion_m: float = 0.5,
        confirm_updates: int = 3,
        silent_time_min_s: float = 1.0,
        silent_time_per_confirmed: float = 1.0,
        silent_time_max_s: float = 10.0,
        silent_velocity_time_s: float = 0.5,
        acceleration_density_m2ps3: float = 0.1,
        measurement_std_m: float = 0.3,
        velocity_std_mps: float = 1.2,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def acceleration_density_m2ps3(self) -> float:
        """
        [m^2/s^3]
        """
    @acceleration_density_m2ps3.setter
    def acceleration_density_m2ps3(self, value: float) -> None: ...
    @property
    def birth_exclusion_m(self) -> float:
        """
        [m]
        """
    @birth_exclusion_m.setter
    def birth_exclusion_m(self, value: float) -> None: ...
    @property
    def confirm_updates(self) -> int:
        """
        the first point included
        """
    @confirm_updates.setter
    def confirm_updates(self, value: int) -> None: ...
    @property
    def cost_max_m(self) -> float:
        """
        [m] of hypothesis_cost
        """
    @cost_max_m.setter
    def cost_max_m(self, value: float) -> None: ...
    @property
    def gate_m(self) -> float:
        """
        [m]
        """
    @gate_m.setter
    def gate_m(self, value: float) -> None: ...
    @property
    def gate_sigma(self) -> float:
        """
        deviations, of kalman; 0: no test
        """
    @gate_sigma.setter
    def gate_sigma(self, value: float) -> None: ...
    @property
    def measurement_std_m(self) -> float:
        """
        [m] of kalman
        """
    @measurement_std_m.setter
    def measurement_std_m(self, value: float) -> None: ...
    @property
    def silent_gate_growth_mps(self) -> float:
        """
        [m/s]
        """
    @silent_gate_growth_mps.setter
    def silent_gate_growth_mps(self, value: float) -> None: ...
    @property
    def silent_gate_max_m(self) -> float:
        """
        [m]
        """
    @silent_gate_max_m.setter
    def silent_gate_max_m(self, value: float) -> None: ...
    @property
    def silent_time_max_s(self) -> float:
        """
        [s]
        """
    @silent_time_max_s.setter
    def silent_time_max_s(self, value: float) -> None: ...
    @property
    def silent_time_min_s(self) -> float:
        """
        [s]
        """
    @silent_time_min_s.setter
    def silent_time_min_s(self, value: float) -> None: ...
    @property
    def silent_velocity_time_s(self) -> float:
        """
        [s]
        """
    @silent_velocity_time_s.setter
    def silent_velocity_time_s(self, value: float) -> None: ...
    @property
    def velocity_std_mps(self) -> float:
        """
        [m/s]
        """
    @velocity_std_mps.setter
    def velocity_std_mps(self, value: float) -> None: ...

class TrackManager:
    """
    Tracks from the points of each frame.
    """
    def __init__(self) -> None: ...
    def configure(self, config: TrackManagerConfig) -> Status: ...
    def process(
        self, points: numpy.typing.NDArray[numpy.float32], dt_s: typing.SupportsFloat | typing.SupportsIndex
    ) -> tuple[Status, numpy.typing.NDArray[numpy.void]]:
        """
        (status, structured array of Track) of points (n, 7): x, y, vx, vy, covariance xx, xy, yy.
        """
    def reset(self) -> None: ...
    @property
    def dropped_births(self) -> int: ...
    @property
    def point_of_track(self) -> numpy.typing.NDArray[numpy.int32]: ...

class TrackManager3d:
    """
    Tracks from the points of each frame.
    """
    def __init__(self) -> None: ...
    def configure(self, config: TrackManagerConfig) -> Status: ...
    def process(
        self, points: numpy.typing.NDArray[numpy.float32], dt_s: typing.SupportsFloat | typing.SupportsIndex
    ) -> tuple[Status, numpy.typing.NDArray[numpy.void]]:
        """
        (status, structured array of Track) of points (n, 12): x, y, z, vx, vy, vz, covariance xx, xy, yy, xz, yz, zz.
        """
    def reset(self) -> None: ...
    @property
    def dropped_births(self) -> int: ...
    @property
    def point_of_track(self) -> numpy.typing.NDArray[numpy.int32]: ...

class PhdTracker:
    """
    Particle PHD filter, its peaks, tracks.
    """
    def __init__(self) -> None: ...
    def configure(self, phd: PhdConfig, em: MixtureConfig, tracks: TrackManagerConfig) -> Status: ...
    def process(
        self,
        measurements: numpy.typing.NDArray[numpy.float32],
        dt_s: typing.SupportsFloat | typing.SupportsIndex,
    ) -> tuple:
        """
        (status, structured array of Track) of measurements (m, 2) [m].
        """
    def process_with_taps(
        self,
        measurements: numpy.typing.NDArray[numpy.float32],
        dt_s: typing.SupportsFloat | typing.SupportsIndex,
    ) -> tuple:
        """
        (status, tracks, taps): taps by TapId, each (n, columns).
        """
    def reset(self) -> None: ...
    @property
    def dropped_births(self) -> int: ...
    @property
    def mass(self) -> float: ...

class KalmanTracker:
    """
    A Kalman filter a track and global nearest neighbour.
    """
    def __init__(self) -> None: ...
    def configure(self, config: TrackManagerConfig) -> Status: ...
    def process(
        self,
        measurements: numpy.typing.NDArray[numpy.float32],
        dt_s: typing.SupportsFloat | typing.SupportsIndex,
    ) -> tuple:
        """
        (status, structured array of Track) of measurements (m, 2) [m].
        """
    def process_with_taps(
        self,
        measurements: numpy.typing.NDArray[numpy.float32],
        dt_s: typing.SupportsFloat | typing.SupportsIndex,
    ) -> tuple:
        """
        (status, tracks, taps): taps by TapId, each (n, columns).
        """
    def reset(self) -> None: ...
    @property
    def dropped_births(self) -> int: ...

class KalmanTracker3d:
    """
    A Kalman filter a track and global nearest neighbour.
    """
    def __init__(self) -> None: ...
    def configure(self, config: TrackManagerConfig) -> Status: ...
    def process(
        self,
        measurements: numpy.typing.NDArray[numpy.float32],
        dt_s: typing.SupportsFloat | typing.SupportsIndex,
    ) -> tuple:
        """
        (status, structured array of Track) of measurements (m, 3) [m].
        """
    def process_with_taps(
        self,
        measurements: numpy.typing.NDArray[numpy.float32],
        dt_s: typing.SupportsFloat | typing.SupportsIndex,
    ) -> tuple:
        """
        (status, tracks, taps): taps by TapId, each (n, columns).
        """
    def reset(self) -> None: ...
    @property
    def dropped_births(self) -> int: ...

class RangeTrackerConfig:
    """
    Tracks from the nodes' paths; scores are logs.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    candidate_detection_probability: float
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> RangeTrackerConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> RangeTrackerConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        detection_probability: float = 0.96,
        far_detection_probability: float = 0.8,
        shadowed_detection_probability: float = 0.66,
        far_shadowed_detection_probability: float = 0.25,
        shadow_radius_m: float = 0.3,
        penumbra_m: float = 0.7,
        path_scale_m: float = 0.08,
        path_std_m: float = 0.12,
        visible_path_m: float = 0.45,
        nearest_path_m: float = 0.45,
        shared_path_m: float = 0.4,
        shared_score: float = -0.5,
        gate_m: float = 0.5,
        clutter_ahead_per_m: float = 0.01,
        clutter_near_per_m: float = 0.55,
        clutter_far_per_m: float = 0.25,
        far_m: float = 3.5,
        ahead_m: float = 0.3,
        window_frames: int = 15,
        newcomer_cost: float = 40.0,
        lasting_score: float = 65.0,
        identity_score: float = 5.0,
        confirm_frames: int = 5,
        silent_nodes: int = 3,
        acceleration_density_m2ps3: float = 0.05,
        newborn_position_std_m: float = 0.2,
        newborn_velocity_std_mps: float = 1.2,
        max_speed_mps: float = 2.5,
        candidate_detection_probability: float = 0.85,
        candidate_clutter_per_m: float = 0.15,
        candidate_memory: float = 0.8,
        drop_score: float = 2.0,
        merge_distance_m: float = 0.6,
        birth_step_m: float = 0.2,
        birth_score: float = 0.5,
        max_births: int = 10,
        birth_exclusion_m: float = 0.6,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def acceleration_density_m2ps3(self) -> float:
        """
        [m^2/s^3]
        """
    @acceleration_density_m2ps3.setter
    def acceleration_density_m2ps3(self, value: float) -> None: ...
    @property
    def ahead_m(self) -> float:
        """
        [m] a detection so far ahead of a person is behind him yet
        """
    @ahead_m.setter
    def ahead_m(self, value: float) -> None: ...
    @property
    def birth_exclusion_m(self) -> float:
        """
        [m]
        """
    @birth_exclusion_m.setter
    def birth_exclusion_m(self, value: float) -> None: ...
    @property
    def birth_score(self) -> float:
        """
        least
        """
    @birth_score.setter
    def birth_score(self, value: float) -> None: ...
    @property
    def birth_step_m(self) -> float:
        """
        [m] of the grid
        """
    @birth_step_m.setter
    def birth_step_m(self, value: float) -> None: ...
    @property
    def candidate_clutter_per_m(self) -> float:
        """
        [1/m]
        """
    @candidate_clutter_per_m.setter
    def candidate_clutter_per_m(self, value: float) -> None: ...
    @property
    def candidate_memory(self) -> float:
        """
        of a score, per frame
        """
    @candidate_memory.setter
    def candidate_memory(self, value: float) -> None: ...
    @property
    def clutter_ahead_per_m(self) -> float:
        """
        [1/m] behind nobody
        """
    @clutter_ahead_per_m.setter
    def clutter_ahead_per_m(self, value: float) -> None: ...
    @property
    def clutter_far_per_m(self) -> float:
        """
        [1/m] further
        """
    @clutter_far_per_m.setter
    def clutter_far_per_m(self, value: float) -> None: ...
    @property
    def clutter_near_per_m(self) -> float:
        """
        [1/m] up to far_m behind somebody
        """
    @clutter_near_per_m.setter
    def clutter_near_per_m(self, value: float) -> None: ...
    @property
    def confirm_frames(self) -> int:
        """
        least age
        """
    @confirm_frames.setter
    def confirm_frames(self, value: int) -> None: ...
    @property
    def detection_probability(self) -> float:
        """
        in the clear
        """
    @detection_probability.setter
    def detection_probability(self, value: float) -> None: ...
    @property
    def drop_score(self) -> float:
        """
        an unconfirmed track below dies
        """
    @drop_score.setter
    def drop_score(self, value: float) -> None: ...
    @property
    def far_detection_probability(self) -> float:
        """
        in the clear, more than far_m behind the first
        """
    @far_detection_probability.setter
    def far_detection_probability(self, value: float) -> None: ...
    @property
    def far_m(self) -> float:
        """
        [m]
        """
    @far_m.setter
    def far_m(self, value: float) -> None: ...
    @property
    def far_shadowed_detection_probability(self) -> float:
        """
        with somebody in the way, far
        """
    @far_shadowed_detection_probability.setter
    def far_shadowed_detection_probability(self, value: float) -> None: ...
    @property
    def gate_m(self) -> float:
        """
        [m] of path
        """
    @gate_m.setter
    def gate_m(self, value: float) -> None: ...
    @property
    def identity_score(self) -> float:
        """
        for each who was there before
        """
    @identity_score.setter
    def identity_score(self, value: float) -> None: ...
    @property
    def lasting_score(self) -> float:
        """
        for as many people as before
        """
    @lasting_score.setter
    def lasting_score(self, value: float) -> None: ...
    @property
    def max_births(self) -> int:
        """
        per frame
        """
    @max_births.setter
    def max_births(self, value: int) -> None: ...
    @property
    def max_speed_mps(self) -> float:
        """
        [m/s] of an unconfirmed track
        """
    @max_speed_mps.setter
    def max_speed_mps(self, value: float) -> None: ...
    @property
    def merge_distance_m(self) -> float:
        """
        [m]
        """
    @merge_distance_m.setter
    def merge_distance_m(self, value: float) -> None: ...
    @property
    def nearest_path_m(self) -> float:
        """
        [m] behind the direct path the nearest detections are
        """
    @nearest_path_m.setter
    def nearest_path_m(self, value: float) -> None: ...
    @property
    def newborn_position_std_m(self) -> float:
        """
        [m] per coordinate
        """
    @newborn_position_std_m.setter
    def newborn_position_std_m(self, value: float) -> None: ...
    @property
    def newborn_velocity_std_mps(self) -> float:
        """
        [m/s] per coordinate
        """
    @newborn_velocity_std_mps.setter
    def newborn_velocity_std_mps(self, value: float) -> None: ...
    @property
    def newcomer_cost(self) -> float:
        """
        by which one more has to explain better
        """
    @newcomer_cost.setter
    def newcomer_cost(self, value: float) -> None: ...
    @property
    def path_scale_m(self) -> float:
        """
        [m] mean deviation
        """
    @path_scale_m.setter
    def path_scale_m(self, value: float) -> None: ...
    @property
    def path_std_m(self) -> float:
        """
        [m] of the filters
        """
    @path_std_m.setter
    def path_std_m(self, value: float) -> None: ...
    @property
    def penumbra_m(self) -> float:
        """
        [m] nearer, half in the way
        """
    @penumbra_m.setter
    def penumbra_m(self, value: float) -> None: ...
    @property
    def shadow_radius_m(self) -> float:
        """
        [m] nearer to a leg, somebody is in the way
        """
    @shadow_radius_m.setter
    def shadow_radius_m(self, value: float) -> None: ...
    @property
    def shadowed_detection_probability(self) -> float:
        """
        with somebody in the way
        """
    @shadowed_detection_probability.setter
    def shadowed_detection_probability(self, value: float) -> None: ...
    @property
    def shared_path_m(self) -> float:
        """
        [m] two people nearer in path may be one detection
        """
    @shared_path_m.setter
    def shared_path_m(self, value: float) -> None: ...
    @property
    def shared_score(self) -> float:
        """
        of the one without
        """
    @shared_score.setter
    def shared_score(self, value: float) -> None: ...
    @property
    def silent_nodes(self) -> int:
        """
        fewer with a detection: silent
        """
    @silent_nodes.setter
    def silent_nodes(self, value: int) -> None: ...
    @property
    def visible_path_m(self) -> float:
        """
        [m] behind the direct path; nobody is seen nearer
        """
    @visible_path_m.setter
    def visible_path_m(self, value: float) -> None: ...
    @property
    def window_frames(self) -> int:
        """
        that a set of people is judged by
        """
    @window_frames.setter
    def window_frames(self, value: int) -> None: ...

class RangeTracker:
    """
    Tracks people by the nodes' paths themselves.
    """
    def __init__(self) -> None: ...
    def configure(
        self,
        config: RangeTrackerConfig,
        body_radius_m: typing.SupportsFloat | typing.SupportsIndex,
        nodes: collections.abc.Sequence[NodeSite],
        area: Area,
    ) -> Status: ...
    def process(
        self,
        node_index: numpy.typing.NDArray[numpy.int32],
        path_m: numpy.typing.NDArray[numpy.float32],
        dt_s: typing.SupportsFloat | typing.SupportsIndex,
    ) -> tuple[Status, numpy.typing.NDArray[numpy.void]]:
        """
        (status, structured array of Track) of detections by ascending node, then path (n,).
        """
    def reset(self) -> None: ...
    @property
    def dropped_births(self) -> int: ...

class Tracker:
    """
    Members:

      phd

      kalman

      range
    """

    __members__: typing.ClassVar[dict[str, Tracker]]
    kalman: typing.ClassVar[Tracker]
    phd: typing.ClassVar[Tracker]
    range: typing.ClassVar[Tracker]
    @typing.overload
    def __eq__(self, other: Tracker) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: Tracker) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class SensorRadarHubConfig:
    """
    The hub of the pipeline sensor_radar.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    ellipse: EllipseConfig
    em: MixtureConfig
    frame_assembler: FrameAssemblerConfig
    phd: PhdConfig
    point_clusters: PointClusterConfig
    ranges: RangeTrackerConfig
    selection: SelectionConfig
    tracks: TrackManagerConfig
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> SensorRadarHubConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> SensorRadarHubConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        nodes: collections.abc.Sequence[NodeSite] = ...,
        n_nodes: int = 0,
        area: Area = ...,
        frame_period_s: float = 0.1,
        aid_missed_frames: int = 3,
        tracker: Tracker = ...,
        frame_assembler: FrameAssemblerConfig = ...,
        ellipse: EllipseConfig = ...,
        selection: SelectionConfig = ...,
        point_clusters: PointClusterConfig = ...,
        phd: PhdConfig = ...,
        em: MixtureConfig = ...,
        tracks: TrackManagerConfig = ...,
        ranges: RangeTrackerConfig = ...,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    def set_area(
        self,
        min_x_m: typing.SupportsFloat | typing.SupportsIndex,
        min_y_m: typing.SupportsFloat | typing.SupportsIndex,
        max_x_m: typing.SupportsFloat | typing.SupportsIndex,
        max_y_m: typing.SupportsFloat | typing.SupportsIndex,
    ) -> None: ...
    def set_nodes(
        self,
        node_ids: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex],
        tx_m: numpy.typing.NDArray[numpy.float32],
        rx_m: numpy.typing.NDArray[numpy.float32],
    ) -> None:
        """
        Sets nodes and n_nodes from positions (n, 2) [m].
        """
    @property
    def aid_missed_frames(self) -> int:
        """
        tracks silent for more frames do not help the selection, >= 0
        """
    @aid_missed_frames.setter
    def aid_missed_frames(self, value: int) -> None: ...
    @property
    def area(self) -> Area:
        """
        where people are looked for
        """
    @area.setter
    def area(self, value: Area) -> None: ...
    @property
    def frame_period_s(self) -> float:
        """
        [s] taken for the first frame, > 0
        """
    @frame_period_s.setter
    def frame_period_s(self, value: float) -> None: ...
    @property
    def n_nodes(self) -> int:
        """
        at least 3
        """
    @n_nodes.setter
    def n_nodes(self, value: int) -> None: ...
    @property
    def nodes(self) -> collections.abc.Sequence[NodeSite]:
        """
        the first n_nodes
        """
    @nodes.setter
    def nodes(self, value: collections.abc.Sequence[NodeSite]) -> None: ...
    @property
    def tracker(self) -> Tracker:
        """
        what follows the points
        """
    @tracker.setter
    def tracker(self, value: Tracker) -> None: ...

class SensorRadarHub:
    """
    The nodes' reports in, tracks out.
    """
    def __init__(self) -> None: ...
    def configure(self, config: SensorRadarHubConfig) -> Status: ...
    def counters(self) -> dict:
        """
        What happened since configure(), by name.
        """
    def poll(self, now_us: typing.SupportsInt | typing.SupportsIndex) -> tuple:
        """
        (status, None or (time_us, frame, tracks)); call until None. tracks is a structured array of Track.
        """
    def poll_with_taps(
        self, now_us: typing.SupportsInt | typing.SupportsIndex
    ) -> tuple[typing.Any, typing.Any, dict]:
        """
        (status, None or (time_us, frame, tracks), taps by name, each (n, columns)).
        """
    def receive(
        self,
        node_id: typing.SupportsInt | typing.SupportsIndex,
        frame: typing.SupportsInt | typing.SupportsIndex,
        delay_s: numpy.typing.NDArray[numpy.float32],
        weight: numpy.typing.NDArray[numpy.float32],
        now_us: typing.SupportsInt | typing.SupportsIndex,
        time_us: typing.SupportsInt | typing.SupportsIndex = 0,
    ) -> Status:
        """
        One node's report; frame counts the node's scans, time_us is the scan's by the node's clock (0: not known).
        """
    def reset(self) -> None: ...

class PathTrackerConfig:
    """
    Tracks that choose among the receivers' traces.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    max_tracks: int
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> PathTrackerConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> PathTrackerConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        acceleration_density_m2ps3: float = 1.0,
        velocity_std_mps: float = 1.0,
        path_std_m: float = 0.06,
        common_path_std_m: float = 0.1,
        gate: float = 16.0,
        missing_cost: float = 4.0,
        lone_gate: float = 6.6,
        lone_limit: int = 9,
        cut_off: float = 1.5,
        confirm_updates: int = 5,
        confirm_window: int = 8,
        silent_time_s: float = 1.0,
        silent_velocity_time_s: float = 0.5,
        birth_exclusion_m: float = 0.7,
        merge_distance_m: float = 0.3,
        merge_speed_mps: float = 0.6,
        max_tracks: int = 10,
        turn_density_m2ps3: float = 0.0,
        turn_begin_probability: float = 0.005,
        turn_end_probability: float = 0.05,
        path_std_growth: float = 0.0,
        body_half_height_m: float = 0.0,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def acceleration_density_m2ps3(self) -> float:
        """
        [m^2/s^3], > 0
        """
    @acceleration_density_m2ps3.setter
    def acceleration_density_m2ps3(self, value: float) -> None: ...
    @property
    def birth_exclusion_m(self) -> float:
        """
        [m] from other tracks, >= 0
        """
    @birth_exclusion_m.setter
    def birth_exclusion_m(self, value: float) -> None: ...
    @property
    def body_half_height_m(self) -> float:
        """
        [m] in space, >= 0; 0: a ball
        """
    @body_half_height_m.setter
    def body_half_height_m(self, value: float) -> None: ...
    @property
    def common_path_std_m(self) -> float:
        """
        [m] of what all share, >= 0
        """
    @common_path_std_m.setter
    def common_path_std_m(self, value: float) -> None: ...
    @property
    def confirm_updates(self) -> int:
        """
        of the last responses, >= 1
        """
    @confirm_updates.setter
    def confirm_updates(self, value: int) -> None: ...
    @property
    def confirm_window(self) -> int:
        """
        responses, at most 32
        """
    @confirm_window.setter
    def confirm_window(self, value: int) -> None: ...
    @property
    def cut_off(self) -> float:
        """
        deviations of a difference of paths, > 0
        """
    @cut_off.setter
    def cut_off(self, value: float) -> None: ...
    @property
    def gate(self) -> float:
        """
        squared distance of a combination, > 0
        """
    @gate.setter
    def gate(self, value: float) -> None: ...
    @property
    def lone_gate(self) -> float:
        """
        squared distance of a single trace, >= 0
        """
    @lone_gate.setter
    def lone_gate(self, value: float) -> None: ...
    @property
    def lone_limit(self) -> int:
        """
        responses in a row, >= 0
        """
    @lone_limit.setter
    def lone_limit(self, value: int) -> None: ...
    @property
    def merge_distance_m(self) -> float:
        """
        [m] two that are one person, >= 0
        """
    @merge_distance_m.setter
    def merge_distance_m(self, value: float) -> None: ...
    @property
    def merge_speed_mps(self) -> float:
        """
        [m/s] and as fast, >= 0
        """
    @merge_speed_mps.setter
    def merge_speed_mps(self, value: float) -> None: ...
    @property
    def missing_cost(self) -> float:
        """
        for each receiver without a trace, >= 0
        """
    @missing_cost.setter
    def missing_cost(self, value: float) -> None: ...
    @property
    def path_std_growth(self) -> float:
        """
        [1/m] of both path deviations beyond 4 m, >= 0
        """
    @path_std_growth.setter
    def path_std_growth(self, value: float) -> None: ...
    @property
    def path_std_m(self) -> float:
        """
        [m] of one receiver's path for itself, > 0
        """
    @path_std_m.setter
    def path_std_m(self, value: float) -> None: ...
    @property
    def silent_time_s(self) -> float:
        """
        [s] for which a track may be silent, >= 0
        """
    @silent_time_s.setter
    def silent_time_s(self, value: float) -> None: ...
    @property
    def silent_velocity_time_s(self) -> float:
        """
        [s] fades with it, >= 0
        """
    @silent_velocity_time_s.setter
    def silent_velocity_time_s(self, value: float) -> None: ...
    @property
    def turn_begin_probability(self) -> float:
        """
        [1] that somebody begins to turn in one response, in (0, 1)
        """
    @turn_begin_probability.setter
    def turn_begin_probability(self, value: float) -> None: ...
    @property
    def turn_density_m2ps3(self) -> float:
        """
        [m^2/s^3] velocity variance gained by one who turns, >= 0; 0: nobody does
        """
    @turn_density_m2ps3.setter
    def turn_density_m2ps3(self, value: float) -> None: ...
    @property
    def turn_end_probability(self) -> float:
        """
        [1] that somebody who turns walks straight on in the next, in (0, 1)
        """
    @turn_end_probability.setter
    def turn_end_probability(self, value: float) -> None: ...
    @property
    def velocity_std_mps(self) -> float:
        """
        [m/s] at birth, > 0
        """
    @velocity_std_mps.setter
    def velocity_std_mps(self, value: float) -> None: ...

class PathTracker:
    def __init__(self) -> None: ...
    def begin(
        self,
        position_m: numpy.typing.NDArray[numpy.float32],
        covariance_m2: numpy.typing.NDArray[numpy.float32],
    ) -> Status:
        """
        At a fix (d,) [m] of covariance (d, d) [m^2].
        """
    def configure(
        self,
        config: PathTrackerConfig,
        wall: WallConfig,
        rx_m: numpy.typing.NDArray[numpy.float32],
        least_m: numpy.typing.NDArray[numpy.float32],
        most_m: numpy.typing.NDArray[numpy.float32],
        body_radius_m: typing.SupportsFloat | typing.SupportsIndex = 0.0,
    ) -> Status:
        """
        rx_m (n, d) from the transmitter, corners least_m, most_m (d,) of where people can be [m].
        """
    def dropped_births(self) -> int: ...
    def reset(self) -> None: ...
    def tracks(self) -> numpy.typing.NDArray[numpy.void]:
        """
        Structured array of Track.
        """
    def update(
        self,
        paths_m: collections.abc.Sequence[typing.Annotated[numpy.typing.ArrayLike, numpy.float32]],
        dt_s: typing.SupportsFloat | typing.SupportsIndex,
    ) -> tuple[Status, numpy.typing.NDArray[numpy.int32]]:
        """
        (status, owners): paths_m is a list of one array a receiver (n,) [m]; owners is the id of the track that took each, one after the other, 0 if none did.
        """

class PathTracker3d:
    def __init__(self) -> None: ...
    def begin(
        self,
        position_m: numpy.typing.NDArray[numpy.float32],
        covariance_m2: numpy.typing.NDArray[numpy.float32],
    ) -> Status:
        """
        At a fix (d,) [m] of covariance (d, d) [m^2].
        """
    def configure(
        self,
        config: PathTrackerConfig,
        wall: WallConfig,
        rx_m: numpy.typing.NDArray[numpy.float32],
        least_m: numpy.typing.NDArray[numpy.float32],
        most_m: numpy.typing.NDArray[numpy.float32],
        body_radius_m: typing.SupportsFloat | typing.SupportsIndex = 0.0,
    ) -> Status:
        """
        rx_m (n, d) from the transmitter, corners least_m, most_m (d,) of where people can be [m].
        """
    def dropped_births(self) -> int: ...
    def reset(self) -> None: ...
    def tracks(self) -> numpy.typing.NDArray[numpy.void]:
        """
        Structured array of Track.
        """
    def update(
        self,
        paths_m: collections.abc.Sequence[typing.Annotated[numpy.typing.ArrayLike, numpy.float32]],
        dt_s: typing.SupportsFloat | typing.SupportsIndex,
    ) -> tuple[Status, numpy.typing.NDArray[numpy.int32]]:
        """
        (status, owners): paths_m is a list of one array a receiver (n,) [m]; owners is the id of the track that took each, one after the other, 0 if none did.
        """

class ThroughWallHubConfig:
    """
    The hub of the pipeline through_wall_2d.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    frame_assembler: FrameAssemblerConfig
    line_locator: LineLocatorConfig
    path_tracker: PathTrackerConfig
    trace_pairing: TracePairingConfig
    tracks: TrackManagerConfig
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> ThroughWallHubConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> ThroughWallHubConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        nodes: collections.abc.Sequence[NodeSite] = ...,
        n_nodes: int = 0,
        area: Area = ...,
        frame_period_s: float = 0.074,
        body_radius_m: float = 0.21,
        track_aided: bool = True,
        frame_assembler: FrameAssemblerConfig = ...,
        trace_pairing: TracePairingConfig = ...,
        line_locator: LineLocatorConfig = ...,
        path_tracker: PathTrackerConfig = ...,
        tracks: TrackManagerConfig = ...,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    def set_area(
        self,
        min_x_m: typing.SupportsFloat | typing.SupportsIndex,
        min_y_m: typing.SupportsFloat | typing.SupportsIndex,
        max_x_m: typing.SupportsFloat | typing.SupportsIndex,
        max_y_m: typing.SupportsFloat | typing.SupportsIndex,
    ) -> None: ...
    def set_nodes(
        self,
        node_ids: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex],
        tx_m: numpy.typing.NDArray[numpy.float32],
        rx_m: numpy.typing.NDArray[numpy.float32],
    ) -> None:
        """
        Sets nodes and n_nodes from positions (n, 2) [m].
        """
    @property
    def area(self) -> Area:
        """
        the room behind the wall
        """
    @area.setter
    def area(self, value: Area) -> None: ...
    @property
    def body_radius_m(self) -> float:
        """
        [m] from an echo's beginning to a person's middle, >= 0
        """
    @body_radius_m.setter
    def body_radius_m(self, value: float) -> None: ...
    @property
    def frame_period_s(self) -> float:
        """
        [s] taken for the first frame, > 0
        """
    @frame_period_s.setter
    def frame_period_s(self, value: float) -> None: ...
    @property
    def n_nodes(self) -> int:
        """
        at least 2, on a line with their one transmitter
        """
    @n_nodes.setter
    def n_nodes(self, value: int) -> None: ...
    @property
    def nodes(self) -> collections.abc.Sequence[NodeSite]:
        """
        the first n_nodes
        """
    @nodes.setter
    def nodes(self, value: collections.abc.Sequence[NodeSite]) -> None: ...
    @property
    def track_aided(self) -> bool:
        """
        tracks take part in the pairing
        """
    @track_aided.setter
    def track_aided(self, value: bool) -> None: ...

class ThroughWallHub:
    """
    The nodes' reports in, tracks out.
    """
    def __init__(self) -> None: ...
    def configure(self, config: ThroughWallHubConfig) -> Status: ...
    def counters(self) -> dict:
        """
        What happened since configure(), by name.
        """
    def poll(self, now_us: typing.SupportsInt | typing.SupportsIndex) -> tuple:
        """
        (status, None or (time_us, frame, tracks)); call until None. tracks is a structured array of Track.
        """
    def poll_with_taps(
        self, now_us: typing.SupportsInt | typing.SupportsIndex
    ) -> tuple[typing.Any, typing.Any, dict]:
        """
        (status, None or (time_us, frame, tracks), taps by name, each (n, columns)).
        """
    def receive(
        self,
        node_id: typing.SupportsInt | typing.SupportsIndex,
        frame: typing.SupportsInt | typing.SupportsIndex,
        delay_s: numpy.typing.NDArray[numpy.float32],
        weight: numpy.typing.NDArray[numpy.float32],
        now_us: typing.SupportsInt | typing.SupportsIndex,
        time_us: typing.SupportsInt | typing.SupportsIndex = 0,
    ) -> Status:
        """
        One node's report; frame counts the node's scans, time_us is the scan's by the node's clock (0: not known).
        """
    def reset(self) -> None: ...

class Point3:
    """
    A position in space.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> Point3: ...
    def __deepcopy__(self, memo: typing.Any) -> Point3: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(self, *, x_m: float = 0.0, y_m: float = 0.0, z_m: float = 0.0) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def x_m(self) -> float:
        """
        [m]
        """
    @x_m.setter
    def x_m(self, value: float) -> None: ...
    @property
    def y_m(self) -> float:
        """
        [m]
        """
    @y_m.setter
    def y_m(self, value: float) -> None: ...
    @property
    def z_m(self) -> float:
        """
        [m]
        """
    @z_m.setter
    def z_m(self, value: float) -> None: ...

class Box:
    """
    A room along the axes, edges included.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> Box: ...
    def __deepcopy__(self, memo: typing.Any) -> Box: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        min_x_m: float = 0.0,
        min_y_m: float = 0.0,
        min_z_m: float = 0.0,
        max_x_m: float = 0.0,
        max_y_m: float = 0.0,
        max_z_m: float = 0.0,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def max_x_m(self) -> float:
        """
        [m]
        """
    @max_x_m.setter
    def max_x_m(self, value: float) -> None: ...
    @property
    def max_y_m(self) -> float:
        """
        [m]
        """
    @max_y_m.setter
    def max_y_m(self, value: float) -> None: ...
    @property
    def max_z_m(self) -> float:
        """
        [m]
        """
    @max_z_m.setter
    def max_z_m(self, value: float) -> None: ...
    @property
    def min_x_m(self) -> float:
        """
        [m]
        """
    @min_x_m.setter
    def min_x_m(self, value: float) -> None: ...
    @property
    def min_y_m(self) -> float:
        """
        [m]
        """
    @min_y_m.setter
    def min_y_m(self, value: float) -> None: ...
    @property
    def min_z_m(self) -> float:
        """
        [m]
        """
    @min_z_m.setter
    def min_z_m(self, value: float) -> None: ...

class NodeSite3d:
    """
    Transmitter and receiver of one node.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    node_id: int
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> NodeSite3d: ...
    def __deepcopy__(self, memo: typing.Any) -> NodeSite3d: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(self, *, node_id: int = 0, tx: Point3 = ..., rx: Point3 = ...) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    @property
    def rx(self) -> Point3:
        """
        [m]
        """
    @rx.setter
    def rx(self, value: Point3) -> None: ...
    @property
    def tx(self) -> Point3:
        """
        [m]
        """
    @tx.setter
    def tx(self, value: Point3) -> None: ...

class ThroughWall3dHubConfig:
    """
    The hub of the pipeline through_wall_3d.
    """

    __hash__: typing.ClassVar[None]  # type: ignore[assignment]
    frame_assembler: FrameAssemblerConfig
    path_tracker: PathTrackerConfig
    taylor_3d: Taylor3dConfig
    trace_pairing: TracePairingConfig
    tracks: TrackManagerConfig
    @staticmethod
    def fields() -> tuple[str, ...]:
        """
        The names of all fields, in order.
        """
    def __copy__(self) -> ThroughWall3dHubConfig: ...
    def __deepcopy__(self, memo: typing.Any) -> ThroughWall3dHubConfig: ...
    def __eq__(self, other: typing.Any) -> bool: ...
    def __init__(
        self,
        *,
        nodes: collections.abc.Sequence[NodeSite3d] = ...,
        n_nodes: int = 4,
        area: Box = ...,
        frame_period_s: float = 0.074,
        body_radius_m: float = 0.21,
        track_aided: bool = True,
        frame_assembler: FrameAssemblerConfig = ...,
        trace_pairing: TracePairingConfig = ...,
        range_difference_m: float = 0.3,
        taylor_3d: Taylor3dConfig = ...,
        path_std_m: float = 0.06,
        path_tracker: PathTrackerConfig = ...,
        tracks: TrackManagerConfig = ...,
    ) -> None: ...
    def __repr__(self) -> str: ...
    def invalid_field(self) -> str | None:
        """
        Name of the first field with an impossible value, or None.
        """
    def set_area(
        self,
        min_x_m: typing.SupportsFloat | typing.SupportsIndex,
        min_y_m: typing.SupportsFloat | typing.SupportsIndex,
        min_z_m: typing.SupportsFloat | typing.SupportsIndex,
        max_x_m: typing.SupportsFloat | typing.SupportsIndex,
        max_y_m: typing.SupportsFloat | typing.SupportsIndex,
        max_z_m: typing.SupportsFloat | typing.SupportsIndex,
    ) -> None: ...
    def set_nodes(
        self,
        node_ids: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex],
        tx_m: numpy.typing.NDArray[numpy.float32],
        rx_m: numpy.typing.NDArray[numpy.float32],
    ) -> None:
        """
        Sets nodes and n_nodes from positions (n, 3) [m].
        """
    @property
    def area(self) -> Box:
        """
        the room behind the wall
        """
    @area.setter
    def area(self, value: Box) -> None: ...
    @property
    def body_radius_m(self) -> float:
        """
        [m] from an echo's beginning to a person's middle, >= 0
        """
    @body_radius_m.setter
    def body_radius_m(self, value: float) -> None: ...
    @property
    def frame_period_s(self) -> float:
        """
        [s] taken for the first frame, > 0
        """
    @frame_period_s.setter
    def frame_period_s(self, value: float) -> None: ...
    @property
    def n_nodes(self) -> int:
        """
        4, a cross with their one transmitter midway
        """
    @n_nodes.setter
    def n_nodes(self, value: int) -> None: ...
    @property
    def nodes(self) -> collections.abc.Sequence[NodeSite3d]:
        """
        receivers at -d and d along x, then at -d and d up
        """
    @nodes.setter
    def nodes(self, value: collections.abc.Sequence[NodeSite3d]) -> None: ...
    @property
    def path_std_m(self) -> float:
        """
        [m] of the paths that locate a target
        """
    @path_std_m.setter
    def path_std_m(self, value: float) -> None: ...
    @property
    def range_difference_m(self) -> float:
        """
        [m] at most, of both axes' distances, > 0
        """
    @range_difference_m.setter
    def range_difference_m(self, value: float) -> None: ...
    @property
    def track_aided(self) -> bool:
        """
        tracks take part in the pairing
        """
    @track_aided.setter
    def track_aided(self, value: bool) -> None: ...

class ThroughWall3dHub:
    """
    The nodes' reports in, tracks out.
    """
    def __init__(self) -> None: ...
    def configure(self, config: ThroughWall3dHubConfig) -> Status: ...
    def counters(self) -> dict:
        """
        What happened since configure(), by name.
        """
    def poll(self, now_us: typing.SupportsInt | typing.SupportsIndex) -> tuple:
        """
        (status, None or (time_us, frame, tracks)); call until None. tracks is a structured array of Track.
        """
    def poll_with_taps(
        self, now_us: typing.SupportsInt | typing.SupportsIndex
    ) -> tuple[typing.Any, typing.Any, dict]:
        """
        (status, None or (time_us, frame, tracks), taps by name, each (n, columns)).
        """
    def receive(
        self,
        node_id: typing.SupportsInt | typing.SupportsIndex,
        frame: typing.SupportsInt | typing.SupportsIndex,
        delay_s: numpy.typing.NDArray[numpy.float32],
        weight: numpy.typing.NDArray[numpy.float32],
        now_us: typing.SupportsInt | typing.SupportsIndex,
        time_us: typing.SupportsInt | typing.SupportsIndex = 0,
    ) -> Status:
        """
        One node's report; frame counts the node's scans, time_us is the scan's by the node's clock (0: not known).
        """
    def reset(self) -> None: ...

class TransferKind:
    """
    Members:

      message

      request

      response
    """

    __members__: typing.ClassVar[dict[str, TransferKind]]
    message: typing.ClassVar[TransferKind]
    request: typing.ClassVar[TransferKind]
    response: typing.ClassVar[TransferKind]
    @typing.overload
    def __eq__(self, other: TransferKind) -> bool: ...
    @typing.overload
    def __eq__(self, other: typing.Any) -> bool: ...
    def __getstate__(self) -> int: ...
    def __hash__(self) -> int: ...
    def __index__(self) -> int: ...
    def __init__(self, value: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __int__(self) -> int: ...
    @typing.overload
    def __ne__(self, other: TransferKind) -> bool: ...
    @typing.overload
    def __ne__(self, other: typing.Any) -> bool: ...
    def __repr__(self) -> str: ...
    def __setstate__(self, state: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def __str__(self) -> str: ...
    @property
    def name(self) -> str: ...
    @property
    def value(self) -> int: ...

class LinkReader:
    """
    Finds frames in a byte stream.
    """
    def __init__(self, capacity: typing.SupportsInt | typing.SupportsIndex) -> None:
        """
        capacity: [byte] of header, payload and CRC of the longest frame.
        """
    def counters(self) -> dict: ...
    def feed(self, data: str, now_us: typing.SupportsInt | typing.SupportsIndex) -> list:
        """
        [(source, port, transfer_id, payload, kind, destination, priority)] of the transfers completed.
        """

class LinkMachine:
    """
    A machine on the link without a pipeline; a node's registers.
    """
    def __init__(self, node_id: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def feed(self, data: str, now_us: typing.SupportsInt | typing.SupportsIndex) -> bytes:
        """
        What it answers.
        """
    def heartbeat(self, now_us: typing.SupportsInt | typing.SupportsIndex) -> bytes: ...
    def refused_writes(self) -> int: ...

def assign(cost: numpy.typing.NDArray[numpy.float32]) -> tuple[Status, numpy.typing.NDArray[numpy.int32]]:
    """
    (status, column of each row or -1) of the least total cost.
    """

def cassini_ratio(
    to_tx_m: typing.SupportsFloat | typing.SupportsIndex,
    to_rx_m: typing.SupportsFloat | typing.SupportsIndex,
    baseline_m: typing.SupportsFloat | typing.SupportsIndex,
) -> float: ...
def crc16(data: str) -> int: ...
def crc32c(data: str) -> int: ...
def decode_detections(
    source: typing.SupportsInt | typing.SupportsIndex,
    transfer_id: typing.SupportsInt | typing.SupportsIndex,
    payload: str,
) -> tuple[Status, int, int, int, numpy.typing.NDArray[numpy.void]]:
    """
    (status, node_id, frame, time_us, detections)
    """

def decode_spatial_tracks(payload: str) -> tuple[Status, int, int, numpy.typing.NDArray[numpy.void]]:
    """
    (status, time_us, frame, tracks)
    """

def decode_tracks(payload: str) -> tuple[Status, int, int, numpy.typing.NDArray[numpy.void]]:
    """
    (status, time_us, frame, tracks)
    """

def encode_detections(
    time_us: typing.SupportsInt | typing.SupportsIndex,
    delay_s: numpy.typing.NDArray[numpy.float32],
    weight: numpy.typing.NDArray[numpy.float32],
) -> bytes: ...
def encode_spatial_tracks(
    time_us: typing.SupportsInt | typing.SupportsIndex,
    frame: typing.SupportsInt | typing.SupportsIndex,
    tracks: numpy.typing.NDArray[numpy.void],
) -> bytes: ...
def encode_tracks(
    time_us: typing.SupportsInt | typing.SupportsIndex,
    frame: typing.SupportsInt | typing.SupportsIndex,
    tracks: numpy.typing.NDArray[numpy.void],
) -> bytes: ...
def gaussian_kernel(
    squared_distance: numpy.typing.NDArray[numpy.float32],
) -> numpy.typing.NDArray[numpy.float32]:
    """
    exp(-d^2 / 2) of each squared distance (n,), 0 beyond 25.
    """

def hub_registers() -> list[str]:
    """
    Names of a hub's configuration on the link; '#' stands for the index of a node.
    """

def invalid_site(nodes: collections.abc.Sequence[NodeSite], area: Area) -> typing.Any:
    """
    "n_nodes", "nodes" or "area": what makes locating impossible; or None.
    """

def leg_product_m2(
    sum_m: typing.SupportsFloat | typing.SupportsIndex,
    baseline_m: typing.SupportsFloat | typing.SupportsIndex,
    bistatic_angle_rad: typing.SupportsFloat | typing.SupportsIndex,
) -> float: ...
def max_leg_product_m2(
    bistatic_constant_m4: typing.SupportsFloat | typing.SupportsIndex,
    min_snr: typing.SupportsFloat | typing.SupportsIndex,
) -> float: ...
def node_registers() -> list[str]:
    """
    Names of a node's configuration on the link.
    """

def path_length(
    position: Point, tx: Point, rx: Point, body_radius_m: typing.SupportsFloat | typing.SupportsIndex
) -> tuple[float, float, float]:
    """
    (path [m], its derivatives with respect to x and y).
    """

def planar_3d(
    method: Planar3dMethod,
    spacing_m: typing.SupportsFloat | typing.SupportsIndex,
    path_m: numpy.typing.NDArray[numpy.float32],
) -> Planar3dFix: ...
def rectify(samples: numpy.typing.NDArray[numpy.float32]) -> numpy.typing.NDArray[numpy.float32]:
    """
    Half-wave rectifier: a new array, negative values 0.
    """

def snr(
    bistatic_constant_m4: typing.SupportsFloat | typing.SupportsIndex,
    to_tx_m: typing.SupportsFloat | typing.SupportsIndex,
    to_rx_m: typing.SupportsFloat | typing.SupportsIndex,
) -> float: ...
def snr_on_ellipse(
    bistatic_constant_m4: typing.SupportsFloat | typing.SupportsIndex,
    sum_m: typing.SupportsFloat | typing.SupportsIndex,
    baseline_m: typing.SupportsFloat | typing.SupportsIndex,
    bistatic_angle_rad: typing.SupportsFloat | typing.SupportsIndex,
) -> float: ...
def sum_on_cassini_m(
    bistatic_constant_m4: typing.SupportsFloat | typing.SupportsIndex,
    snr: typing.SupportsFloat | typing.SupportsIndex,
    baseline_m: typing.SupportsFloat | typing.SupportsIndex,
    bistatic_angle_rad: typing.SupportsFloat | typing.SupportsIndex,
) -> float: ...
def systematic_resample(
    weights: numpy.typing.NDArray[numpy.float32],
    uniform: typing.SupportsFloat | typing.SupportsIndex,
    n_out: typing.SupportsInt | typing.SupportsIndex,
) -> tuple[Status, numpy.typing.NDArray[numpy.uint16]]:
    """
    (status, indices (n_out,)).
    """

def through_wall_3d_hub_registers() -> list[str]:
    """
    Names of a hub's configuration on the link; '#' stands for the index of a node.
    """

def through_wall_hub_registers() -> list[str]:
    """
    Names of a hub's configuration on the link; '#' stands for the index of a node.
    """

def through_wall_node_registers() -> list[str]:
    """
    Names of a through-wall node's configuration on the link.
    """

def time_of_arrival_s(
    to_tx_m: typing.SupportsFloat | typing.SupportsIndex, to_rx_m: typing.SupportsFloat | typing.SupportsIndex
) -> float: ...
def two_ellipses(
    path1_m: typing.SupportsFloat | typing.SupportsIndex,
    path2_m: typing.SupportsFloat | typing.SupportsIndex,
    rx1_x_m: typing.SupportsFloat | typing.SupportsIndex,
    rx2_x_m: typing.SupportsFloat | typing.SupportsIndex,
) -> LineFix: ...
def write_frame(
    source: typing.SupportsInt | typing.SupportsIndex,
    port: typing.SupportsInt | typing.SupportsIndex,
    transfer_id: typing.SupportsInt | typing.SupportsIndex,
    payload: str,
    *,
    kind: TransferKind = TransferKind.message,
    destination: typing.SupportsInt | typing.SupportsIndex = 65535,
    priority: typing.SupportsInt | typing.SupportsIndex = 4,
) -> bytes:
    """
    One frame with its delimiters.
    """

LIMITS: dict = {
    "max_samples_per_scan": 1920,
    "max_response_samples": 4095,
    "max_hits_per_scan": 1920,
    "max_clusters_per_scan": 64,
    "max_detections_per_node": 16,
    "max_nodes": 16,
    "max_frame_history": 8,
    "max_tuples_per_frame": 4096,
    "max_measurements_per_frame": 256,
    "max_points_per_frame": 32,
    "max_targets": 16,
    "max_tracks": 24,
    "max_particles": 2048,
    "max_newborn_particles": 1024,
    "max_assignment": 32,
}
MEASUREMENT_STAGES_BYTES: int = 34640
SENSOR_RADAR_HUB_BYTES: int = 201576
SENSOR_RADAR_NODE_BYTES: int = 65928
TAPS: dict = {
    0: ("scan", 0),
    1: ("envelope", 0),
    2: ("direct_path", 0),
    3: ("alignment", 0),
    4: ("aligned", 0),
    5: ("residual", 0),
    6: ("threshold", 0),
    7: ("decisions", 0),
    8: ("range_clusters", 4),
    9: ("detections", 2),
    10: ("time_zero", 0),
    11: ("rotated", 0),
    12: ("subtracted", 0),
    13: ("enhanced", 0),
    14: ("target_traces", 2),
    15: ("leading_edges", 2),
    32: ("frame", 3),
    33: ("selected", 5),
    34: ("points", 4),
    35: ("predicted", 5),
    36: ("updated", 5),
    37: ("resampled", 5),
    38: ("peaks", 5),
    39: ("tracks", 7),
    40: ("associated", 0),
    41: ("points", 5),
    42: ("tracks", 9),
}
THROUGH_WALL_3D_HUB_BYTES: int = 44808
THROUGH_WALL_HUB_BYTES: int = 28816
THROUGH_WALL_NODE_BYTES: int = 57936
