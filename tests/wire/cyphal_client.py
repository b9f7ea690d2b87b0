"""A client that is not ours: PyCyphal and the DSDL, none of echofuse's code.

It runs in a process of its own, since the namespace of the messages is called `echofuse` as well.

python cyphal_client.py compile DSDL_FOLDER OUTPUT_FOLDER
python cyphal_client.py listen OUTPUT_FOLDER PORT NODE_ID HUB_ID

`listen` joins serial:socket://127.0.0.1:PORT, prints a line `ready`, and at the end one line of JSON:
what it has read, and what the node's registers said to it.
"""

import asyncio
import json
import sys
from pathlib import Path
from typing import Any

import pycyphal.dsdl
from pycyphal.presentation import Presentation
from pycyphal.transport.serial import SerialTransport

OWN_ID = 0xF002
DETECTIONS, TRACKS, NODE_HEALTH = 6200, 6201, 6205
PATIENCE_S = 60.0


def compile_dsdl(dsdl: Path, output: Path) -> None:
    """Generate the Python packages `uavcan` and `echofuse`."""
    pycyphal.dsdl.compile_all([dsdl / "uavcan", dsdl / "echofuse"], output_directory=output)


def plain(message: Any) -> Any:
    """Return a message as what JSON knows."""
    return pycyphal.dsdl.to_builtin(message)


class Client:
    """What has been heard, and the questions to one node."""

    def __init__(self, port: int) -> None:
        self._presentation = Presentation(SerialTransport(f"socket://127.0.0.1:{port}", OWN_ID))
        self.heard: dict[str, list[dict[str, Any]]] = {}

    def subscribe(self, name: str, type_: Any, subject: int) -> None:
        """Keep every message of a subject, with who sent it and its transfer id."""
        kept = self.heard[name] = []

        async def keep(message: Any, transfer: Any) -> None:
            about = {"source": transfer.source_node_id, "transfer_id": transfer.transfer_id}
            kept.append(about | {"message": plain(message)})

        self._presentation.make_subscriber(type_, subject).receive_in_background(keep)

    async def wait_for(self, what: str, found: Any) -> None:
        """Wait until `found()`, or end with what was waited for."""
        deadline = asyncio.get_event_loop().time() + PATIENCE_S
        while not found():
            if asyncio.get_event_loop().time() > deadline:
                counts = {name: len(kept) for name, kept in self.heard.items()}
                raise SystemExit(f"no {what} within {PATIENCE_S:g} s; heard {counts}")
            await asyncio.sleep(0.02)

    async def ask(self, service: Any, number: int, node_id: int, request: Any) -> Any:
        """Return the answer to one request."""
        client = self._presentation.make_client(service, number, node_id)
        client.response_timeout = PATIENCE_S
        answer = await client.call(request)
        if answer is None:
            raise SystemExit(f"node {node_id} does not answer service {number}")
        return answer[0]

    def close(self) -> None:
        """Leave the link."""
        self._presentation.close()


async def registers(client: Client, node_id: int) -> dict[str, Any]:
    """List the registers; read one, write it and put it back; try to write one that is the board's."""
    import uavcan.primitive.array
    import uavcan.register

    async def access(name: str, value: Any = None) -> Any:
        request = uavcan.register.Access_1_0.Request(uavcan.register.Name_1_0(name))
        if value is not None:
            request.value = value
        return await client.ask(uavcan.register.Access_1_0, 384, node_id, request)

    names: list[str] = []
    while not names or names[-1]:
        asked = uavcan.register.List_1_0.Request(len(names))
        answer = await client.ask(uavcan.register.List_1_0, 385, node_id, asked)
        names.append(answer.name.name.tobytes().decode())
    real = uavcan.primitive.array.Real32_1_0
    before = await access("cfar.global_factor")
    written = await access("cfar.global_factor", uavcan.register.Value_1_0(real32=real([4.5])))
    restored = await access("cfar.global_factor", before.value)
    number = uavcan.register.Value_1_0(natural16=uavcan.primitive.array.Natural16_1_0([77]))
    refused = await access("uavcan.node.id", number)
    return {
        "names": names[:-1],
        "before": plain(before),
        "written": plain(written),
        "restored": plain(restored),
        "refused": plain(refused),
    }


async def listen(port: int, node_id: int, hub_id: int) -> dict[str, Any]:
    """Read every kind of message until each was there, and then ask the node."""
    import uavcan.node
    import uavcan.time

    import echofuse  # the namespace of cpp/dsdl

    client = Client(port)
    client.subscribe("heartbeat", uavcan.node.Heartbeat_1_0, 7509)
    client.subscribe("synchronization", uavcan.time.Synchronization_1_0, 7168)
    client.subscribe("detections", echofuse.Detections_1_0, DETECTIONS)
    client.subscribe("tracks", echofuse.Tracks_1_0, TRACKS)
    client.subscribe("health", echofuse.NodeHealth_1_0, NODE_HEALTH)
    print("ready", flush=True)
    heard = client.heard
    await client.wait_for(
        "heartbeats of node and hub",
        lambda: {node_id, hub_id} <= {beat["source"] for beat in heard["heartbeat"]},
    )
    await client.wait_for("detections", lambda: any(m["message"]["detections"] for m in heard["detections"]))
    await client.wait_for("tracks", lambda: any(m["message"]["tracks"] for m in heard["tracks"]))
    await client.wait_for("health of both", lambda: {m["message"]["kind"] for m in heard["health"]} == {0, 1})
    await client.wait_for("time", lambda: heard["synchronization"])
    info = await client.ask(uavcan.node.GetInfo_1_0, 430, node_id, uavcan.node.GetInfo_1_0.Request())
    result = heard | {"name": info.name.tobytes().decode(), "registers": await registers(client, node_id)}
    client.close()
    return result


if __name__ == "__main__":
    command, *arguments = sys.argv[1:]
    if command == "compile":
        compile_dsdl(*map(Path, arguments))
    else:
        sys.path.insert(0, arguments[0])  # before any installed echofuse
        print(json.dumps(asyncio.run(listen(*map(int, arguments[1:])))))
