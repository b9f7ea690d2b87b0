"""Emulated radars, links and faults around the very firmware, and the targets that it can run on."""
