"""How far a target may be from the reference, and why: one row a compared quantity.

The rows stand in one file a room (`node.py`, `hub.py`, ...) as ``ROWS``; this module merges them.
"""

from importlib import import_module
from pkgutil import iter_modules

from echofuse.conformance.tolerances._tolerance import Tolerance

__all__ = ["TOLERANCES", "Tolerance"]

TOLERANCES: dict[str, Tolerance] = {
    name: tolerance
    for module in iter_modules(__path__)
    if not module.name.startswith("_")
    for name, tolerance in import_module(f"{__name__}.{module.name}").ROWS.items()
}
