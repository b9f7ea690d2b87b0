"""The vectors, made by PyCyphal (make_vectors.py)."""

import tomllib
from dataclasses import dataclass
from pathlib import Path

import pytest


@dataclass(frozen=True)
class Vector:
    """One message on the wire."""

    name: str
    subject: int
    source: int
    transfer_id: int
    payload: bytes
    frame: bytes


def _vectors() -> list[Vector]:
    tables = tomllib.loads((Path(__file__).parent / "vectors.toml").read_text())
    return [
        Vector(
            name=name,
            subject=table["subject"],
            source=table["source"],
            transfer_id=table["transfer_id"],
            payload=bytes.fromhex(table["payload"]),
            frame=bytes.fromhex(table["frame"]),
        )
        for name, table in tables.items()
    ]


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Give every vector to a test that takes one."""
    if "vector" in metafunc.fixturenames:
        vectors = _vectors()
        metafunc.parametrize("vector", vectors, ids=[vector.name for vector in vectors])


@pytest.fixture(scope="session")
def vectors() -> dict[str, Vector]:
    return {vector.name: vector for vector in _vectors()}
