"""Find people with radars: the library for nodes and hub, its reference, and the harness around both.

Importing this package loads nothing heavy; import what you need from its modules.
"""

__version__ = "0.1.0"
