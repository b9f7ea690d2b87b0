"""How good tracks are: errors against the truth, OSPA, and the bounds that nothing can beat."""
