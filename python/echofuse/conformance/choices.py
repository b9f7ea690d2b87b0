"""What is conformed: each choice of each stage, one at a time from the default, and some together."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

Settings = Mapping[str, Any]  # "stage.field" or "field" -> value, a choice as its word


SELECTING = ("selection.", "ellipse.")


@dataclass(frozen=True, kw_only=True)
class Choice:
    """One row of the table."""

    name: str
    settings: Settings = field(default_factory=dict)
    learns: bool = False  # nobody gives the background: the node learns it
    shared_transmitter: bool = False  # hub: possible only where all nodes share one
    long_sequence: bool = False  # through-wall node: on the stairs' responses of 4095 samples

    def selects(self, number: int, frame: int) -> bool:
        """Whether the selection, by far the slowest of the reference, is compared in a frame of an input.

        One frame of every input under choices that bear on it, before or after a track is confirmed; else of
        some inputs.
        """
        bears = self.name == "default" or any(key.startswith(SELECTING) for key in self.settings)
        return frame == (1, 5, 5, 8)[number % 4] and (bears or number % 4 == 1)


def _one(key: str, *values: Any, learns: bool = False) -> Iterator[Choice]:
    """One choice a value of one field."""
    for value in values:
        name = f"{key}={value}" + (", learnt" if learns else "")
        yield Choice(name=name, settings={key: value, **(LEARNING if learns else {})}, learns=learns)


def configure(config: object, settings: Settings) -> None:
    """Set "stage.field" and "field" on a bound configuration; a choice by its word."""
    for key, value in settings.items():
        *stages, name = key.split(".")
        owner = config
        for stage in stages:
            owner = getattr(owner, stage)
        members = getattr(type(getattr(owner, name)), "__members__", None)
        setattr(owner, name, value if members is None else members[value])


LEARNING: Settings = {"clutter.learning_scans": 3}

NODE_CHOICES: tuple[Choice, ...] = (
    Choice(name="default"),
    *_one("time_zero", "recorded"),
    *_one("pulse_integrator.pulses_per_scan", 2),
    *_one("envelope.method", "square_low_pass"),
    *_one("direct_path.search", "threshold_crossing", "jump_back_search_forward"),
    *_one("alignment.method", "integer", "none"),
    *_one(
        "clutter.method", "empty_room_scan", "empty_room_shadowed", "exponential_average", "frame_difference"
    ),
    *_one(
        "clutter.method",
        "empty_room_envelope",
        "empty_room_scan",
        "exponential_average",
        "frame_difference",
        learns=True,
    ),
    Choice(
        name="clutter.difference_lag_scans=2",
        settings={"clutter.method": "frame_difference", "clutter.difference_lag_scans": 2},
    ),
    *_one("cfar.method", "cell_averaging", "global_average", "ordered_statistic"),
    *_one("noise_floor.factor", 3.0),
    *_one("range_clusters.representative", "median"),
    Choice(
        name="the paper's",
        settings={
            "cfar.method": "double_threshold_buffer",
            "range_clusters.representative": "median",
            "direct_path.search": "serial_backward",
        },
    ),
    Choice(
        name="coherent, cell averaging, median",
        settings={
            "clutter.method": "empty_room_scan",
            "cfar.method": "cell_averaging",
            "range_clusters.representative": "median",
        },
    ),
    Choice(
        name="learnt, exponential, ordered statistic, recorded, noise floor",
        settings={
            **LEARNING,
            "clutter.method": "exponential_average",
            "cfar.method": "ordered_statistic",
            "time_zero": "recorded",
            "noise_floor.factor": 2.5,
        },
        learns=True,
    ),
    Choice(
        name="square law, whole samples, global average, crossing",
        settings={
            "envelope.method": "square_low_pass",
            "alignment.method": "integer",
            "cfar.method": "global_average",
            "direct_path.search": "threshold_crossing",
        },
    ),
)

THROUGH_WALL_NODE_CHOICES: tuple[Choice, ...] = (
    Choice(name="default"),
    *_one("kept_samples", 200),
    Choice(name="kept_samples=700 of 4095", settings={"kept_samples": 700}, long_sequence=True),
    *_one("max_delay_s", 3.3e-8),
    *_one("time_zero.learning_responses", 4),
    *_one("time_zero.moved_responses", 1),
    *_one("clutter.method", "empty_room_scan", "empty_room_shadowed", "frame_difference"),
    *_one("envelope.method", "square_low_pass"),
    *_one("weak_signal.floor_factor", 0.0),
    *_one("gaussian_cfar.spread", "rms"),
    *_one("target_traces.density_correction", True),
    *_one("leading_edge.fraction", 0.3),
    *_one("leading_edge.rule", "contrast"),
    Choice(
        name="fewer hits, denser, blind longer",
        settings={
            "gaussian_cfar.deviations": 1.0,
            "gaussian_cfar.slow_factor": 0.02,
            "target_traces.density_correction": True,
            "blind_zone_s": 1e-8,
        },
    ),
)

STAIRS_NODE_CHOICES: tuple[Choice, ...] = tuple(
    replace(choice, long_sequence=True)
    for choice in (
        Choice(name="default"),
        *_one("leading_edge.rule", "contrast", "fraction"),
        *_one("clutter.method", "frame_difference"),
        *_one("target_traces.density_correction", False),
    )
)

PAIR_FIRST: Settings = {"track_aided": False}

THROUGH_WALL_HUB_CHOICES: tuple[Choice, ...] = (
    Choice(name="default"),
    *_one("line_locator.wall.compensation", "none", "first_kind"),
    *_one("body_radius_m", 0.0),
    *_one("path_tracker.lone_gate", 0.0),
    *_one("path_tracker.silent_velocity_time_s", 0.0),
    *_one("path_tracker.missing_cost", 0.0),
    Choice(
        name="quick tracks",
        settings={"path_tracker.confirm_updates": 1, "path_tracker.birth_exclusion_m": 0.0},
    ),
    Choice(name="track_aided=False", settings=PAIR_FIRST),
    Choice(name="track_aided=False, all pairs", settings={**PAIR_FIRST, "trace_pairing.rule": "all_pairs"}),
    Choice(name="track_aided=False, printed", settings={**PAIR_FIRST, "trace_pairing.closing": "printed"}),
    Choice(
        name="track_aided=False, nothing completed",
        settings={**PAIR_FIRST, "trace_pairing.completion_limit": 0},
    ),
)

START_ALONE: Settings = {"taylor_3d.max_iterations": 0}

# Not trace_pairing.closing=printed, whose couples all lie along the antennas: a cross locates none of them.
THROUGH_WALL_3D_HUB_CHOICES: tuple[Choice, ...] = (
    Choice(name="default"),
    *_one("taylor_3d.start", "approximate"),
    *_one("taylor_3d.max_iterations", 0, 20),
    Choice(name="A-3D-2D alone", settings={**START_ALONE, "taylor_3d.start": "approximate"}),
    *_one("taylor_3d.wall.compensation", "none", "first_kind", "second_kind"),
    *_one("range_difference_m", 0.1),
    *_one("trace_pairing.rule", "all_pairs"),
    *_one("path_tracker.body_half_height_m", 0.0, 0.8),
    *_one("path_tracker.turn_density_m2ps3", 0.0, 4.0),
    *_one("path_tracker.path_std_growth", 0.0, 0.2),
    *_one("path_tracker.lone_gate", 0.0),
    Choice(name="track_aided=False", settings=PAIR_FIRST),
    Choice(name="track_aided=False, all pairs", settings={**PAIR_FIRST, "trace_pairing.rule": "all_pairs"}),
    Choice(
        name="track_aided=False, nothing completed",
        settings={**PAIR_FIRST, "trace_pairing.completion_limit": 0},
    ),
    Choice(name="track_aided=False, 3D-2D alone", settings={**PAIR_FIRST, **START_ALONE}),
    Choice(
        name="track_aided=False, A-3D-2D alone",
        settings={**PAIR_FIRST, **START_ALONE, "taylor_3d.start": "approximate"},
    ),
)

ALL_TUPLES: Settings = {"selection.method": "all_tuples"}
TUPLES_OF_4: Settings = {
    **ALL_TUPLES,
    "selection.nodes_per_tuple": 4,
}  # fewer, for the reference takes its time

HUB_CHOICES: tuple[Choice, ...] = (
    Choice(name="default"),
    *_one("selection.method", "all_tuples"),
    *_one("selection.nodes_per_tuple", 4),
    Choice(name="all tuples of 4", settings={**TUPLES_OF_4, "selection.min_weight": 40.0}),
    Choice(
        name="selection.residual=equation_residual",
        settings={
            **TUPLES_OF_4,
            "selection.residual": "equation_residual",
            "selection.max_equation_residual_m3": 5.0,
        },
        shared_transmitter=True,
    ),
    *_one("selection.track_aided", False),
    *_one("selection.echo_tail_m", 1.5),
    Choice(name="ellipse.refinement=none", settings={**TUPLES_OF_4, "ellipse.refinement": "none"}),
    *_one("ellipse.body_radius_m", 0.2),
    *_one("ellipse.robust_scale_m", 0.0),
    *(
        Choice(
            name=f"point_clusters.distance={kind}", settings={**TUPLES_OF_4, "point_clusters.distance": kind}
        )
        for kind in ("centroid", "minimum", "maximum")
    ),
    *_one("tracker", "kalman"),
    Choice(name="tracker=range", settings={"tracker": "range", "ranges.birth_step_m": 0.8}),
    *_one("phd.resampling", "proportional"),
    *_one("phd.mass_average_frames", 3),
    *_one("em.initialisation", "k_means_plus_plus"),
    *_one("em.background_density_per_m2", 0.0),
    *_one("tracks.association", "hypothesis_cost"),
    *_one("tracks.update", "kalman"),
    Choice(
        name="kalman, hypothesis_cost",
        settings={"tracker": "kalman", "tracks.association": "hypothesis_cost"},
    ),
    Choice(
        name="the paper's",
        settings={
            **TUPLES_OF_4,
            "ellipse.refinement": "none",
            "selection.min_weight": 40.0,
            "selection.residual": "equation_residual",
            "selection.max_equation_residual_m3": 5.0,
            "selection.track_aided": False,
            "phd.resampling": "proportional",
            "em.initialisation": "k_means_plus_plus",
            "em.background_density_per_m2": 0.0,
            "tracks.association": "hypothesis_cost",
        },
        shared_transmitter=True,
    ),
)
