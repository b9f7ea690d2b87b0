"""The examples run as they stand and say something sensible."""

import re
import runpy
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
