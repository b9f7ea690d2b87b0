"""Site files (TOML): where nodes stand, what they watch, and how the pipeline is configured."""

from echofuse.site.loader import example_site, example_sites, load_site, parse_site
from echofuse.site.model import Site, SiteNode, TruePath, Wall, bare_site
from echofuse.site.stages import PIPELINES, apply_settings

__all__ = [
    "PIPELINES",
    "Site",
    "SiteNode",
    "TruePath",
    "Wall",
    "apply_settings",
    "bare_site",
    "example_site",
    "example_sites",
    "load_site",
    "parse_site",
]
