"""Time from frame to frame, never 0 and never backwards."""


class FrameClock:
    """State: the last frame's time, and how often the clock stood still or ran back."""

    def __init__(self) -> None:
        self.last_time_us: int | None = None
        self.faults = 0

    def step_s(self, time_us: int, period_s: float) -> float:
        """Time since the last frame; period_s at first and when the clock stands."""
        last, self.last_time_us = self.last_time_us, time_us
        if last is None:
            return period_s
        if time_us > last:
            return (time_us - last) * 1e-6
        self.faults += 1
        return period_s
