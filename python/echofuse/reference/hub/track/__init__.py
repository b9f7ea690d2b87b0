"""From located points to tracks: particle PHD filter, track manager, Kalman baseline."""
