"""Settings of the range tracker; scores are natural logarithms of likelihoods, so they add up."""

from typing import Protocol

WINDOW_FRAMES_MAX = 16


class RangeTrackerConfig(Protocol):
    # What a node detects of a person; far: more than far_m of path behind the first person.
    detection_probability: float
    far_detection_probability: float
    shadowed_detection_probability: float
    far_shadowed_detection_probability: float
    shadow_radius_m: float
    penumbra_m: float
    path_scale_m: float
    path_std_m: float
    visible_path_m: float
    nearest_path_m: float
    shared_path_m: float
    shared_score: float
    gate_m: float
    # Other detections, per metre of path.
    clutter_ahead_per_m: float
    clutter_near_per_m: float
    clutter_far_per_m: float
    far_m: float
    ahead_m: float
    # Who is there.
    window_frames: int
    newcomer_cost: float
    lasting_score: float
    identity_score: float
    confirm_frames: int
    silent_nodes: int
    # Motion, and the tracks that are not confirmed.
    acceleration_density_m2ps3: float
    newborn_position_std_m: float
    newborn_velocity_std_mps: float
    max_speed_mps: float
    candidate_detection_probability: float
    candidate_clutter_per_m: float
    candidate_memory: float
    drop_score: float
    merge_distance_m: float
    birth_step_m: float
    birth_score: float
    max_births: int
    birth_exclusion_m: float
