"""The targets `process` and `cortex-m7` for the emulation: each machine is a board that runs the firmware."""

from collections.abc import Sequence

from echofuse import _core
from echofuse.emulation.firmware import HUB_ID
from echofuse.emulation.firmware import Machine as BoardMachine
from echofuse.emulation.lockstep import PROFILE_TOTAL
from echofuse.emulation.machine import Machine, ScanInput, StepOutput, named_taps
from echofuse.emulation.targets.boards import BoardOpener
from echofuse.pipeline import hub_config, node_config, places_of
from echofuse.recording import NodeRecording
from echofuse.site import Site


class FirmwareTarget:
    """Boards of one kind."""

    def __init__(self, name: str, site: Site, sources: Sequence[NodeRecording]) -> None:
        self.name = name
        self._site, self._sources = site, tuple(sources)
        self._places = places_of(site, sources)
        self._open_board = BoardOpener(name, site.pipeline)

    def open_node(self, index: int) -> Machine:
        """Start a node, write its configuration, and show it the empty room."""
        source = self._sources[index]
        place = self._places.get(source.node_id)
        if place is None:
            from echofuse.emulation.targets.inprocess import InProcessNode

            return InProcessNode(source.node_id, None)
        machine = BoardMachine(self._open_board("node", source.name, source.node_id), source.node_id)
        try:
            machine.configure(node_config(self._site, place, source))
            machine.show_empty_room([] if source.reference is None else list(source.reference))
        except BaseException:
            machine.board.close()
            raise
        return FirmwareMachine(machine)

    def open_hub(self) -> Machine:
        """Start the hub and write its configuration."""
        machine = BoardMachine(self._open_board("hub", "hub", HUB_ID), HUB_ID)
        try:
            machine.configure(hub_config(self._site))
        except BaseException:
            machine.board.close()
            raise
        return FirmwareMachine(machine)

    def close(self) -> None:
        """Leave the lines that no machine took."""
        self._open_board.close()


class FirmwareMachine:
    """One board, configured."""

    def __init__(self, machine: BoardMachine) -> None:
        self._machine = machine
        self._configuration_frames = machine.requests  # which its link has counted

    def step(
        self, now_us: int, link_in: bytes = b"", scan: ScanInput | None = None, *, taps: bool = False
    ) -> StepOutput:
        """Let the board work at one moment."""
        done, _ = self._machine.step(
            now_us,
            link_in,
            scan=None if scan is None else scan.samples,
            scan_time_us=0 if scan is None else scan.time_us,
            taps=taps,
        )
        profile = {_core.TAPS[tap][0]: ticks for tap, ticks in done.profile.items() if tap != PROFILE_TOTAL}
        return StepOutput(
            link_out=done.link,
            taps=named_taps(done.taps),
            profile=profile,
            total_ticks=done.profile.get(PROFILE_TOTAL),
        )

    def counters(self, now_us: int) -> dict[str, int]:
        """Return what the firmware says that it has counted, when it next says so."""
        self._machine.ask_health(now_us)
        counted = dict(self._machine.health)
        for name in ("ticks_max", "link_stack_bytes"):  # no counters
            counted.pop(name, None)
        counted["link_frames"] = counted.get("link_frames", 0) - self._configuration_frames
        return counted

    def close(self) -> None:
        """Switch the board off."""
        self._machine.board.close()
