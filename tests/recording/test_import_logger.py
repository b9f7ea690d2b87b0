"""The vendor's logger files: made up ones for what can be wrong, and the real walk where it is at hand."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat

from echofuse.errors import InputError
from echofuse.recording import read, write
from echofuse.recording.importers import import_logger, read_logger, recognise_site
from echofuse.site import Site, SiteNode, example_site, parse_site

DATA = Path(os.environ.get("ECHOFUSE_DATA") or Path(__file__).parents[3] / "shared" / "data")
WALK = DATA / "p410-triangle"
needs_walk = pytest.mark.skipif(not WALK.is_dir(), reason=f"the real walk is not at hand: no folder {WALK}")


@pytest.fixture
def site() -> Site:
    places = {11: (0.0, 0.0), 12: (4.0, 0.0), 13: (0.0, 4.0)}
    return Site(
        name="hall",
        nodes=tuple(
            SiteNode(
                name=f"n{node_id}",
                id=node_id,
                tx_position_m=(x, y, 0.0),
                rx_position_m=(x + 0.1, y, 0.0),
                transmit_delay_s=2e-9 if node_id == 12 else 0.0,
            )
            for node_id, (x, y) in places.items()
        ),
        area=((0.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)),
        pipeline="sensor_radar",
    )


def save(path: Path, node_id: int, *, n_scans: int = 6, n_samples: int = 8, **changes: Sequence[Any]) -> Path:
    """Write a file as the logger does; `changes` replace a column of `scn`."""
    columns: dict[str, Sequence[Any]] = {
        "T": [5_000_000 + node_id + 33 * scan for scan in range(n_scans)],
        "msgID": range(n_scans),
        "Tstrt": [17_499] * n_scans,
        "Tstp": [17_499 + 61 * n_samples] * n_scans,
        "Nscn": [n_samples] * n_scans,
        "scn": [np.arange(n_samples, dtype=np.int32) + 100 * scan for scan in range(n_scans)],
        **changes,
    }
    kept = {key: values for key, values in columns.items() if values}
    scn = np.zeros(n_scans, [(key, object) for key in kept])
    for key, values in kept.items():
        for scan in range(n_scans):
            scn[key][scan] = values[scan]
    savemat(path, {"cfg": {"nodeID": node_id, "T": 4_999_900}, "scn": scn})
    return path


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for node_id in (11, 12, 13):
        save(tmp_path / f"{node_id}_P1.mat", node_id)
    return tmp_path


def message(path: Path, site: Site | None) -> str:
    with pytest.raises(InputError) as caught:
        import_logger(path, site)
    text = str(caught.value)
    assert "\n" not in text
    assert "expected" in text
    return text


def test_a_network_is_imported(folder: Path, site: Site, tmp_path: Path) -> None:
    write(tmp_path / "out.h5", import_logger(folder, site))
    recording = read(tmp_path / "out.h5")
    assert [node.name for node in recording.nodes] == ["n11", "n12", "n13"]
    assert recording.pipeline == "sensor_radar"
    assert recording.site_toml == site.to_toml()
    for offset, node in enumerate(recording.nodes):
        assert node.node_id == 11 + offset
        assert node.sample_rate_hz == pytest.approx(1.0 / 61e-12, rel=1e-9)
        # One time axis: the earliest scan of all is at 0, the hosts' differences stay.
        np.testing.assert_allclose(node.time_s, 1e-3 * offset + 0.033 * np.arange(6), atol=1e-9)
        assert node.scans.dtype == np.int32
        np.testing.assert_array_equal(node.scans, np.arange(8) + 100 * np.arange(6)[:, np.newaxis])
        np.testing.assert_array_equal(node.tx_position_m, site.nodes[offset].tx_position_m)
        np.testing.assert_array_equal(node.rx_position_m, site.nodes[offset].rx_position_m)
    starts = [node.first_sample_s for node in recording.nodes]
    assert starts == pytest.approx([17.499e-9, 15.499e-9, 17.499e-9], abs=1e-15)  # each by its own delay


def test_one_file_is_one_node(folder: Path, site: Site) -> None:
    recording = import_logger(folder / "12_P1.mat", site)
    assert [node.name for node in recording.nodes] == ["n12"]
    assert recording.nodes[0].time_s[0] == 0.0


def test_a_single_scan(tmp_path: Path, site: Site) -> None:
    """MATLAB drops dimensions of 1."""
    path = save(tmp_path / "11.mat", 11, n_scans=1)
    assert import_logger(path, site).nodes[0].scans.shape == (1, 8)


def test_a_network_must_be_whole_and_known(folder: Path, site: Site, tmp_path: Path) -> None:
    assert "--site SITE.toml" in message(folder, None)
    assert "11, 12, 13" in message(folder, None)
    (folder / "13_P1.mat").unlink()
    assert "every node of site 'hall', found none for [13]" in message(folder, site)
    save(folder / "99_P1.mat", 99)
    assert "cfg.nodeID: expected a node of site 'hall' (11, 12, 13), found 99" in message(folder, site)
    save(folder / "99_P1.mat", 11)
    assert "cfg.nodeID: expected another node than" in message(folder, site)
    empty = tmp_path / "empty"
    empty.mkdir()
    assert "none in this folder" in message(empty, site)
    assert "no such file" in message(tmp_path / "missing", site)


BROKEN: dict[str, tuple[dict[str, Sequence[Any]], str]] = {
    "no samples": ({"scn": []}, "scn.scn"),
    "no times": ({"T": []}, "scn.T"),
    "no start": ({"Tstrt": []}, "scn.Tstrt"),
    "start changes": ({"Tstrt": [17_499] * 5 + [20_000]}, "scn.Tstrt: expected the same in all scans"),
    "stop before start": ({"Tstp": [17_000] * 6}, "scn.Tstp: expected more than"),
    "a short scan": ({"scn": [np.zeros(8, np.int32)] * 5 + [np.zeros(7, np.int32)]}, "in scan 5"),
    "fractions": ({"scn": [np.full(8, 0.5)] * 6}, "expected 8 integers a scan"),
    "NaN time": ({"T": [1.0, 2.0, np.nan, 4.0, 5.0, 6.0]}, "T: expected finite numbers"),
    "text for a time": ({"T": ["noon"] * 6}, "T: expected one number each"),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_file_is_named(tmp_path: Path, site: Site, name: str) -> None:
    changes, words = BROKEN[name]
    path = save(tmp_path / "11.mat", 11, **changes)
    text = message(path, site)
    assert text.startswith(f"{path}: ")
    assert words in text


def test_other_files(tmp_path: Path, site: Site) -> None:
    (tmp_path / "text.mat").write_text("hello " * 99)
    assert "MATLAB file" in message(tmp_path / "text.mat", site)
    savemat(tmp_path / "foreign.mat", {"x": np.zeros(3)})
    assert "a struct 'cfg'" in message(tmp_path / "foreign.mat", site)
    whole = save(tmp_path / "cut.mat", 11, n_scans=40).read_bytes()
    for size in np.linspace(1, len(whole) - 1, 15).astype(int):
        (tmp_path / "cut.mat").write_bytes(whole[:size])
        message(tmp_path / "cut.mat", site)


@needs_walk
def test_the_real_walk(tmp_path: Path) -> None:
    recording = import_logger(WALK)  # recognised by its node ids
    site = parse_site(recording.site_toml)
    assert site == example_site("p410_triangle")
    assert [node.node_id for node in recording.nodes] == [101, 102, 104, 106]
    for node in recording.nodes:
        assert node.scans.shape == (1024, 480)
        assert node.sample_rate_hz == pytest.approx(16.384e9, rel=1e-5)
        one_way_m = 0.5 * 299_792_458.0 * (node.first_sample_s + np.array([0, 1]) / node.sample_rate_hz)
        assert one_way_m[0] == pytest.approx(1.1, abs=0.01)
        assert np.diff(one_way_m) == pytest.approx(0.00915, abs=1e-5)
        assert np.median(np.diff(node.time_s)) == pytest.approx(0.0328, abs=0.0005)
        assert 0.0 <= node.time_s[0] <= 0.028 + 1e-9
        assert node.time_s[-1] == pytest.approx(33.55, abs=0.05)
    assert recording.nodes[0].scans[0, :4].tolist() == [152361, 138733, -99673, -129161]
    write(tmp_path / "walk.h5", recording)
    back = read(tmp_path / "walk.h5")
    np.testing.assert_array_equal(back.nodes[3].scans, recording.nodes[3].scans)


@needs_walk
def test_one_real_file_is_recognised_too() -> None:
    assert recognise_site({104}, WALK / "104_P1.mat").name == "P410 triangle"
    log = read_logger(WALK / "104_P1.mat")
    assert (log.node_id, log.start_s) == (104, pytest.approx(17.499e-9))
