"""The examples run as they stand and say something sensible."""

import re
import runpy
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"


def test_sensor_radar(capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path(str(EXAMPLES / "sensor_radar.py"))
    said = capsys.readouterr().out
    error = re.search(r"root mean square error (\d\.\d\d) m", said)
    assert error is not None
    assert float(error.group(1)) < 0.2
    assert len(re.findall(r"person 1 at", said)) > 20


def test_taylor_series_3d(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    script = str(EXAMPLES / "taylor_series_3d.py")
    monkeypatch.setattr(sys, "argv", [script, "2000"])
    runpy.run_path(script, run_name="__main__")
    rows = [line.split(" | ") for line in capsys.readouterr().out.splitlines() if line.startswith("| (")]
    assert len(rows) == 12
    for _, deviations, *cells in rows:
        approximate, planar, _, refined, bound, diverging = (float(cell.strip(" |")) for cell in cells)
        assert diverging == 0
        assert refined == pytest.approx(bound, rel=0.06)
        equal = len(set(deviations.split(", "))) == 1
        assert planar == pytest.approx(refined, rel=0.01) if equal else planar > 1.1 * refined
        assert approximate > 0.99 * planar


def test_wall_compensation(capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path(str(EXAMPLES / "wall_compensation.py"), run_name="__main__")
    rows = [line.strip("| ").split(" | ") for line in capsys.readouterr().out.splitlines()[2:]]
    mean_m = {tuple(row[:3]): float(row[3]) for row in rows}
    largest_m = {tuple(row[:3]): float(row[5]) for row in rows}
    assert len(rows) == 15
    assert largest_m["second_kind", "true", "true"] <= 0.005
    assert mean_m["none", "true", "true"] > 3.0 * mean_m["first_kind", "true", "true"] > 0.1
    wrong = {(thickness, permittivity) for _, thickness, permittivity in mean_m} - {("true", "true")}
    for wall in wrong:
        assert 0.02 < mean_m["second_kind", *wall] < mean_m["first_kind", *wall]
