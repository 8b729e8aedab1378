"""Sends commands to many tiles at once, and waits until each has acknowledged."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from tilenca.fleet.reader import PortReader
from tilenca.fleet.state import Event, PortNews
from tilenca.protocol.describe import words
from tilenca.protocol.sentences import AckSentence, NakSentence

# A tile answers within milliseconds; a command without an answer by then was lost and is sent again.
AGAIN_S = 1.0
ATTEMPTS = 3
TICK_S = 0.05


@dataclass(frozen=True)
class Reply:
    """The result of a command: the fields now in force, or else the `problem`."""

    fields: tuple[str, ...] = ()
    problem: str = ""


def command_all(
    reader: PortReader,
    orders: Mapping[str, bytes],
    name: str,
    hear: Callable[[Event], None] = lambda event: None,
) -> dict[str, Reply]:
    """Sends each port its command and waits for the tile's answer.

    A command without an answer, or damaged on the way, is sent again: it does no harm twice.

    Args:
        reader: with the ports open; the tiles run.
        orders: the command of each port.
        name: of the commands; it identifies the answers.
        hear: called with every event meanwhile.

    Returns:
        A reply for each port, in the order of `orders`.
    """
    replies: dict[str, Reply] = {}
    sent = dict.fromkeys(orders, 0)
    due_s = dict.fromkeys(orders, time.monotonic())
    while len(replies) < len(orders):
        for port, order in orders.items():
            if port in replies or time.monotonic() < due_s[port]:
                continue
            if sent[port] == ATTEMPTS:
                replies[port] = Reply(problem=f"no answer to {ATTEMPTS} commands")
                continue
            reader.write(port, order)
            sent[port] += 1
            due_s[port] = time.monotonic() + AGAIN_S
        for event in reader.poll(TICK_S):
            hear(event)
            if event.port in orders and event.port not in replies and (reply := _reply(event, name)):
                replies[event.port] = reply
    return {port: replies[port] for port in orders}


def _reply(event: Event, name: str) -> Reply | None:
    if isinstance(event, PortNews):
        return None if event.is_open else Reply(problem=event.reason.removesuffix("; waiting for it"))
    match event.sentence:
        case AckSentence(_, command, fields) if command == name:
            return Reply(fields)
        case NakSentence(_, reason, command) as refusal if command in (name, ""):
            # Damaged on the way: it is sent again at the next attempt.
            return None if reason in ("CHECKSUM", "LONG") else Reply(problem=f"refused: {words(refusal)}")
    return None
