"""Writes a site's configurations as a C++ header, so that firmware has them compiled in.

Only what differs from the C++ structures' own defaults is written, under the configurations' own names.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

__all__ = ["cpp_header"]

#: Where C++ declares each configuration.
HEADERS = {
    "SensorRadarNodeConfig": "echofuse/node/node.hpp",
    "SensorRadarHubConfig": "echofuse/hub/hub.hpp",
    "ThroughWallNodeConfig": "echofuse/node/through_wall.hpp",
    "ThroughWallHubConfig": "echofuse/hub/through_wall.hpp",
    "ThroughWall3dHubConfig": "echofuse/hub/through_wall_3d.hpp",
}


def cpp_header(site_name: str, nodes: Mapping[int, Any], hub: Any) -> str:
    """Return the text of site_config.hpp.

    nodes: the pipeline's configuration of a node by node id, at least one; hub: its hub's.
    """
    of_node, of_hub = (type(config).__name__ for config in (next(iter(nodes.values())), hub))
    lines = [
        f"// The site '{' '.join(site_name.split())}', by `echofuse export-config`: edit the site file.",
        "#pragma once",
        "",
        "#include <cstdint>",
        "",
        "#ifdef ECHOFUSE_FIRMWARE_HUB",
        f'#include "{HEADERS[of_hub]}"',
        "#else",
        f'#include "{HEADERS[of_node]}"',
        "#endif",
        "",
        "namespace echofuse::site {",
        "",
        "#ifdef ECHOFUSE_FIRMWARE_HUB",
        f"inline hub::{of_hub} hub_config() {{",
        f"  hub::{of_hub} c;",
        *(f"  {line}" for line in _assignments(hub, type(hub)(), "c")),
        "  return c;",
        "}",
        "#else",
        "/// False when the site has no such node.",
        f"inline bool node_config(std::uint16_t node_id, node::{of_node}& c) {{",
        "  switch (node_id) {",
    ]
    for node_id, config in nodes.items():
        lines += [f"    case {node_id}:", f"      c = node::{of_node}{{}};"]
        lines += [f"      {line}" for line in _assignments(config, type(config)(), "c")]
        lines += ["      return true;"]
    lines += [
        "    default:",
        "      return false;",
        "  }",
        "}",
        "#endif",
        "",
        "}  // namespace echofuse::site",
        "",
    ]
    return "\n".join(lines)


def _assignments(value: Any, default: Any, where: str) -> Iterator[str]:
    """Yield a statement for each field of `value` that differs from `default`."""
    if hasattr(value, "fields"):
        for name in value.fields():
            yield from _assignments(getattr(value, name), getattr(default, name), f"{where}.{name}")
    elif isinstance(value, Sequence) and not isinstance(value, str):
        for index, (item, plain) in enumerate(zip(value, default, strict=True)):
            yield from _assignments(item, plain, f"{where}[{index}]")
    elif value != default:
        yield f"{where} = {_literal(value, where)};"


def _literal(value: Any, where: str) -> str:
    if hasattr(type(value), "__members__"):
        return f"static_cast<decltype({where})>({int(value)}) /* {value.name} */"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    return f"{np.format_float_scientific(np.float32(value), unique=True, trim='0')}f"
