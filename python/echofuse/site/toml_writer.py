"""Writes a site as TOML."""

import json
from collections.abc import Iterable, Mapping
from typing import Any

from echofuse.site.model import Site

__all__ = ["site_to_toml"]


def site_to_toml(site: Site) -> str:
    """Return the text of a site file; what the site does not set is left out."""
    if site.heights_m is not None:
        area: list[Any] = list(site.box_m)
    else:
        area = list(site.bounds_m) if site.area_is_rectangle else [list(vertex) for vertex in site.area]
    lines = ["[site]", *_pairs({"name": site.name, "area": area})]
    if site.wall is not None:
        lines += ["", "[site.wall]", *_pairs(vars(site.wall))]
    for node in site.nodes:
        values = {
            "name": node.name,
            "id": node.id,
            "radar": node.radar or None,
            "tx_position_m": list(node.tx_position_m),
            "rx_position_m": list(node.rx_position_m),
            "time_zero": node.time_zero,
            "delay_offset_s": node.delay_offset_s,
            "transmit_delay_s": node.transmit_delay_s or None,
        }
        lines += ["", "[[node]]", *_pairs(values)]
    lines += _table("pipeline", {"name": site.pipeline, **site.settings})
    if site.truth is not None:
        lines += _table("truth", vars(site.truth))
    return "\n".join(lines) + "\n"


def _table(name: str, values: Mapping[str, Any]) -> list[str]:
    inner = {key: value for key, value in values.items() if isinstance(value, Mapping)}
    lines = ["", f"[{name}]", *_pairs({key: value for key, value in values.items() if key not in inner})]
    for key, value in inner.items():
        lines += _table(f"{name}.{key}", value)
    return lines


def _pairs(values: Mapping[str, Any]) -> list[str]:
    return [f"{key} = {_value(value)}" for key, value in values.items() if value is not None]


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        # A JSON string is a TOML basic string, but for DEL.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Iterable):
        return "[" + ", ".join(_value(item) for item in value) + "]"
    return repr(value)
