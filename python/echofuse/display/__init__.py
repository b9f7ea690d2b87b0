"""Pictures, the report, and progress bars.

Importing this package loads nothing heavy; matplotlib loads when used.
"""
