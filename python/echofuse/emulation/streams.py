"""Random streams, one for each decision of each node, so that one more fault does not shift the others."""

import zlib

import numpy as np

__all__ = ["stream"]


def stream(seed: int, what: str, node: str) -> np.random.Generator:
    """Return the stream of one kind of decision ("link.loss") about one node."""
    return np.random.Generator(np.random.PCG64([seed, zlib.crc32(what.encode()), zlib.crc32(node.encode())]))
