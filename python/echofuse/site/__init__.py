"""Site files (TOML): where nodes stand, what they watch, and how the pipeline is configured."""

from echofuse.site.loader import example_site, example_sites, load_site, parse_site
from echofuse.site.model import Site, SiteNode, TruePath, Wall
from echofuse.site.stages import apply_settings

__all__ = [
    "Site",
    "SiteNode",
    "TruePath",
    "Wall",
    "apply_settings",
    "example_site",
    "example_sites",
    "load_site",
    "parse_site",
]
