"""A run's tables: by their hub's dimension, from this process and from the link."""

from dataclasses import replace

import numpy as np
import pytest

from echofuse import _core
from echofuse.emulation import codec
from echofuse.emulation.targets.inprocess import InProcessHub
from echofuse.recording import Recording
from echofuse.recording.model import SPATIAL_COLUMNS
from echofuse.result import RunResult
from echofuse.run_tables import FrameOutput, RunTables
from echofuse.site import PIPELINES, example_site

POINTS = np.array([[1.0, 2.0, 3.0, 4.0, 5.0], [-1.0, -2.0, -3.0, 2.0, 1.0]], np.float32)


def compiled_tracks() -> np.ndarray:
    """Two tracks as the compiled hubs return them, each field with a value of its own."""
    *_, one = _core.decode_spatial_tracks(bytes(11) + b"\2" + bytes(2 * 55))
    for value, name in enumerate(one.dtype.names):
        one[name] = value, value + 1
    one["state"] = 1, 2
    return one


class SilentHub:
    """A hub that closes one frame."""

    def __init__(self, tracks: np.ndarray) -> None:
        self._closed: list[object] = [(70, 3, tracks), None]

    def poll_with_taps(self, now_us: int) -> tuple[object, object, dict[str, np.ndarray]]:
        return _core.Status.ok, self._closed.pop(0), {}


def over_the_link(dimension: int, tracks: np.ndarray) -> np.ndarray:
    """What the harness reads of a hub's report."""
    output = InProcessHub(SilentHub(tracks), dimension).step(100)  # type: ignore[arg-type]
    (transfer,) = codec.FrameReader().feed(output.link_out)
    assert transfer.port == (codec.SPATIAL_TRACKS if dimension == 3 else codec.TRACKS)
    report = codec.reported_tracks(transfer)
    assert report is not None
    assert report[:2] == (70, 3)
    return report[2]


def run_of(pipeline: str, points: np.ndarray, tracks: np.ndarray) -> RunResult:
    """A run of one frame."""
    recording = Recording(pipeline=pipeline, created="", site_toml="", nodes=())
    tables = RunTables(recording, None)
    tables.add_frame(FrameOutput(time_us=70, points=points, tracks=tracks))
    return tables.result(example_site("through_wall"), {}, 0)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("linked", [False, True])
def test_the_track_table(monkeypatch: pytest.MonkeyPatch, dimension: int, linked: bool) -> None:
    monkeypatch.setitem(PIPELINES, "some", replace(PIPELINES["through_wall_2d"], dimension=dimension))
    tracks = compiled_tracks()
    found = run_of(
        "some", np.zeros((0, 4), np.float32), over_the_link(dimension, tracks) if linked else tracks
    ).tracks
    for name in tracks.dtype.names:
        if dimension == 2 and name in SPATIAL_COLUMNS:
            assert np.all(np.isnan(found[name])), name
        else:
            np.testing.assert_array_equal(found[name], tracks[name], err_msg=name)
    assert np.all(found["time_us"] == 70)


def test_points_have_a_height_where_the_tap_has_one() -> None:
    names = ("x_m", "y_m", "z_m", "members", "weight")
    in_space = run_of("through_wall_2d", POINTS, compiled_tracks()).points
    for column, name in enumerate(names):
        np.testing.assert_array_equal(in_space[name], POINTS[:, column])
    planar = run_of("through_wall_2d", POINTS[:, [0, 1, 3, 4]], compiled_tracks()).points
    assert np.all(np.isnan(planar["z_m"]))
    for column, name in ((0, "x_m"), (1, "y_m"), (3, "members"), (4, "weight")):
        np.testing.assert_array_equal(planar[name], POINTS[:, column])


def test_taps_in_space_have_their_own_numbers_and_widths() -> None:
    wide = {name: columns for number, (name, columns) in _core.TAPS.items() if number > 40}
    assert wide == {"points": 5, "tracks": 9}
