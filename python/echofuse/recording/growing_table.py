"""A dataset that grows in blocks."""

from typing import Any

import h5py
import numpy as np
from numpy.typing import DTypeLike, NDArray

__all__ = ["GrowingTable"]


class GrowingTable:
    """A resizable, chunked dataset, and the rows that wait in memory for the next block."""

    def __init__(
        self, group: h5py.Group, name: str, columns: tuple[int, ...], dtype: DTypeLike, *, block_rows: int
    ) -> None:
        self.block_rows = block_rows
        self.columns = columns
        self.dtype = np.dtype(dtype)
        self._dataset = group.create_dataset(
            name, (0, *columns), self.dtype, chunks=(block_rows, *columns), maxshape=(None, *columns)
        )
        self._waiting: list[NDArray[Any]] = []
        self._n_waiting = 0

    @property
    def full(self) -> bool:
        """Whether a whole block waits."""
        return self._n_waiting >= self.block_rows

    def append(self, rows: NDArray[Any]) -> None:
        """Let rows (n, *columns) wait; they are copied."""
        if len(rows):
            self._waiting.append(rows.copy())
            self._n_waiting += len(rows)

    def write(self) -> None:
        """Hand all that waits to HDF5 (not yet to the operating system)."""
        if not self._waiting:
            return
        start = self._dataset.shape[0]
        self._dataset.resize(start + self._n_waiting, axis=0)
        self._dataset[start:] = np.concatenate(self._waiting)
        self._waiting.clear()
        self._n_waiting = 0
