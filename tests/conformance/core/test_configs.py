"""What every configuration of the core promises to Python."""

import copy
import inspect
from typing import Any

import pytest

from echofuse import _core

CONFIGS = [
    kind for name, kind in inspect.getmembers(_core, inspect.isclass) if hasattr(kind, "invalid_field")
]


@pytest.fixture(params=CONFIGS, ids=lambda kind: kind.__name__)
def kind(request: pytest.FixtureRequest) -> Any:
    return request.param


def test_fields_come_back_by_keyword(kind: Any) -> None:
    config = kind()
    values = {name: getattr(config, name) for name in kind.fields()}
    assert values
    assert kind(**values) == config
    assert config != 0


def test_unknown_and_positional_values_are_refused(kind: Any) -> None:
    with pytest.raises(TypeError, match="no field 'wavelength'"):
        kind(wavelength=1)
    with pytest.raises(TypeError):
        kind(1)


def test_every_field_refuses_another_type(kind: Any) -> None:
    for name in kind.fields():
        with pytest.raises(TypeError, match=name):
            kind(**{name: object()})


def test_a_copy_is_independent(kind: Any) -> None:
    for copied in (copy.copy, copy.deepcopy):
        config = kind()
        other = copied(config)
        assert other == config
        for name in kind.fields():
            value = getattr(config, name)
            if isinstance(value, float):
                setattr(other, name, 2.0 * value + 1.0)
                assert getattr(config, name) == value
                assert other != config
                break


def test_not_a_number_is_named(kind: Any) -> None:
    for name in kind.fields():
        config = kind()
        if isinstance(getattr(config, name), float):
            setattr(config, name, float("nan"))
            assert config.invalid_field() is not None
