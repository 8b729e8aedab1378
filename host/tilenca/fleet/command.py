"""Sends commands to many tiles at once, and waits until each has acknowledged."""

import time
from collections.abc import Mapping
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


class Commands:
    """Commands on their way: they are sent, and sent again where no answer comes. It waits for nothing.

    Attributes:
        replies: of the ports that have answered, or been given up.
    """

    def __init__(self, reader: PortReader, orders: Mapping[str, bytes], name: str) -> None:
        """Sends nothing yet; the arguments are those of `command_all`."""
        self._reader, self._name = reader, name
        self._orders = dict(orders)
        self._sent = dict.fromkeys(orders, 0)
        self._due_s = dict.fromkeys(orders, time.monotonic())
        self.replies: dict[str, Reply] = {}

    @property
    def is_over(self) -> bool:
        """Whether all have."""
        return len(self.replies) == len(self._orders)

    def send(self) -> dict[str, Reply]:
        """Sends what is due; returns the ports that it gives up, since no answer comes."""
        given_up = {}
        for port in self._orders:
            if port in self.replies or time.monotonic() < self._due_s[port]:
                continue
            if self._sent[port] == ATTEMPTS:
                given_up[port] = self.replies[port] = Reply(problem=f"no answer to {ATTEMPTS} commands")
                continue
            self._reader.write(port, self._orders[port])
            self._sent[port] += 1
            self._due_s[port] = time.monotonic() + AGAIN_S
        return given_up

    def take(self, event: Event) -> Reply | None:
        """An event of the reader; returns the reply that it is, if it is one."""
        if event.port not in self._orders or event.port in self.replies:
            return None
        if (reply := _reply(event, self._name)) is None:
            return None
        self.replies[event.port] = reply
        return reply


def command_all(
    reader: PortReader,
    orders: Mapping[str, bytes],
    name: str,
) -> dict[str, Reply]:
    """Sends each port its command and waits for the tile's answer.

    A command without an answer, or damaged on the way, is sent again: it does no harm twice.

    Args:
        reader: with the ports open; the tiles run.
        orders: the command of each port.
        name: of the commands; it identifies the answers.

    Returns:
        A reply for each port, in the order of `orders`.
    """
    commands = Commands(reader, orders, name)
    while not commands.is_over:
        commands.send()
        for event in reader.poll(TICK_S):
            commands.take(event)
    return {port: commands.replies[port] for port in orders}


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
