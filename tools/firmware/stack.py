"""The deepest stack that a program can need, computed from its disassembly.

It follows every path from each entry, instruction by instruction, with the number of bytes on the stack. The
program must not recurse, and the caller must name the targets of calls through pointers: `indirect`.
"""

import re
from collections.abc import Iterable, Mapping, Sequence

from firmware.disassembly import Instruction, Program

# Bytes that a call or an interrupt pushes on a chip with more than 128 KiB of flash.
RETURN_ADDRESS = 3

_RETURNS = {"ret", "reti"}
_SKIPS = {"cpse", "sbrc", "sbrs", "sbic", "sbis"}
_CALLS = {"call", "rcall"}
_JUMPS = {"jmp", "rjmp"}
# Immediate arithmetic that moves Y by a known number of bytes, and instructions that do not change their
# first operand.
_MOVE = re.compile(r"r(28|29), 0x([0-9A-Fa-f]+)")
_MOVES = {"sbiw", "adiw", "subi", "sbci"}
_LEAVE_FIRST_OPERAND = {"in", "cp", "cpc", "cpi", "cpse", "sbrc", "sbrs", "bst", "tst"}
_TABLE_JUMP = "__tablejump2__"
_CONSTRUCTORS = ("_GLOBAL__sub_I_", "_GLOBAL__I_")

# Address, bytes on the stack, and how far Y points below the stack pointer, if it does.
_Path = tuple[int, int, int | None]


class StackError(Exception):
    """The stack use of an instruction cannot be computed; the message names it and its place."""


class StackAnalysis:
    """Computes the depth of the stack below an address; follows each function once."""

    def __init__(self, program: Program, indirect: Mapping[str, Iterable[str]] | None = None) -> None:
        self._program = program
        self._indirect = indirect or {}
        self._depths: dict[int, int] = {}
        self._open: list[int] = []

    def depth(self, entry: int) -> int:
        """Bytes that the code from this entry needs at most, without its own return address.

        Raises:
            StackError: recursion, a call through an unknown pointer, or a jump out of the program.
        """
        if entry in self._open:
            cycle = " -> ".join(
                self._program.name_at(at) for at in [*self._open[self._open.index(entry) :], entry]
            )
            raise StackError(f"recursion: {cycle}. Its depth cannot be known: write it as a loop")
        if entry not in self._depths:
            self._open.append(entry)
            self._depths[entry] = self._walk(entry)
            self._open.pop()
        return self._depths[entry]

    def _walk(self, entry: int) -> int:
        deepest = 0
        seen: set[int] = set()
        paths: list[_Path] = [(entry, 0, None)]
        later: list[_Path] = []  # code that only switch tables may reach
        while paths or later:
            address, used, frame = paths.pop() if paths else later.pop()
            if address in seen:
                continue
            seen.add(address)
            instruction = self._at(address)
            used, frame = _push(instruction, used, frame)
            deepest = max(deepest, used, used + self._called(instruction))
            paths += [(at, used, frame) for at in self._successors(instruction)]
            if instruction.name in _JUMPS and self._is_table_jump(instruction):
                later += [(at, used, frame) for at in self._rest_of_function(address)]
        return deepest

    def _at(self, address: int) -> Instruction:
        if address not in self._program.code:
            raise StackError(f"the program runs to {address:#x}, where there is no code")
        return self._program.code[address]

    def _called(self, instruction: Instruction) -> int:
        if instruction.name in ("icall", "eicall"):
            targets = self._pointed_to(self._program.name_at(instruction.address))
        elif instruction.name not in _CALLS or _is_reservation(instruction):
            return 0
        elif self._is_table_jump(instruction):
            # Called, not jumped to: this is the start-up code on its way through the constructors.
            targets = [
                start for name, start in self._program.functions.items() if name.startswith(_CONSTRUCTORS)
            ]
        elif instruction.target == 0 and instruction.operands == "0":
            return 0  # a weak function that the program lacks; its address is checked before the call
        else:
            targets = [_known(instruction)]
        return max((RETURN_ADDRESS + self.depth(target) for target in targets), default=0)

    def _pointed_to(self, caller: str) -> list[int]:
        if caller not in self._indirect:
            raise StackError(
                f"{caller} calls through a pointer. Name the targets in [stack.indirect] of budgets.toml"
            )
        return [self._program.functions[name] for name in self._indirect[caller]]

    def _successors(self, instruction: Instruction) -> list[int]:
        name = instruction.name
        if name in _RETURNS:
            return []
        if name in ("ijmp", "eijmp"):
            raise StackError(f"{self._program.name_at(instruction.address)} jumps through a pointer")
        if name in _JUMPS:
            return [] if self._is_table_jump(instruction) else [_known(instruction)]
        if name.startswith("br") and name != "break":
            return [instruction.next, _known(instruction)]
        if name in _SKIPS:
            return [instruction.next, self._at(instruction.next).next]
        return [instruction.next]

    def _is_table_jump(self, instruction: Instruction) -> bool:
        table = self._program.functions.get(_TABLE_JUMP)
        return table is not None and instruction.target == table and instruction.name in _CALLS | _JUMPS

    def _rest_of_function(self, address: int) -> Sequence[int]:
        ends = [start for start in self._program.functions.values() if start > address]
        end = min(ends, default=address)
        return [at for at in self._program.code if address < at < end]


def worst_case(program: Program, indirect: Mapping[str, Iterable[str]] | None = None) -> int:
    """Bytes of stack that the program needs at most: from reset, with the deepest interrupt on top.

    Raises:
        StackError: it cannot be computed; an interrupt that lets others interrupt it is such a case.
    """
    analysis = StackAnalysis(program, indirect)
    handlers = [
        start
        for name, start in program.functions.items()
        if name.startswith("__vector_") and name != "__vector_default"
    ]
    for name, start in program.functions.items():
        if name.startswith("__vector_") and _enables_interrupts(program, start):
            raise StackError(f"{name} enables interrupts: how many may nest is not known. Remove its sei")
    interrupt = max((RETURN_ADDRESS + analysis.depth(handler) for handler in handlers), default=0)
    return analysis.depth(0) + interrupt


def _enables_interrupts(program: Program, start: int) -> bool:
    end = min((other for other in program.functions.values() if other > start), default=max(program.code) + 1)
    return any(program.code[at].name == "sei" for at in program.code if start <= at < end)


def _push(instruction: Instruction, used: int, frame: int | None) -> tuple[int, int | None]:
    """Bytes on the stack after the instruction, and the distance of Y below its top (None: unrelated)."""
    name, operands = instruction.name, instruction.operands
    if name == "push":
        return used + 1, frame
    if _is_reservation(instruction):
        return used + RETURN_ADDRESS, frame
    if name == "pop":
        used -= 1
    if name == "in" and operands == "r28, 0x3d":
        return used, 0
    if name == "out" and operands.startswith("0x3d, "):
        return _set_stack_pointer(instruction, used, frame)
    if (name, operands) == ("sbc", "r29, r1"):  # r1 is zero: nothing but the borrow from the low byte
        return used, frame
    moved = _MOVE.fullmatch(operands)
    if frame is not None and moved and name in _MOVES:
        return used, frame + _moved(name, int(moved.group(1)), int(moved.group(2), 16))
    changes_y = operands.split(",")[0] in ("r28", "r29") and name not in _LEAVE_FIRST_OPERAND
    return used, None if changes_y else frame


def _set_stack_pointer(instruction: Instruction, used: int, frame: int | None) -> tuple[int, int | None]:
    if instruction.operands == "0x3d, r28":
        if frame is not None:
            return used + frame, 0
        if used == 0:  # the start-up code, which sets the stack pointer
            return 0, 0
    raise StackError(
        f"the stack pointer is set to an unknown value at {instruction.address:#x}: no alloca, please"
    )


def _moved(name: str, register: int, value: int) -> int:
    """The bytes by which immediate arithmetic moves Y downwards: subi the low byte, sbci the high one."""
    if name == "sbiw":
        return value
    if name == "adiw":
        return -value
    if name == "subi" and register == 28:
        return value
    if name == "sbci" and register == 29:
        return (value << 8) - (0x10000 if value >= 0x80 else 0)
    return 0


def _is_reservation(instruction: Instruction) -> bool:
    """`rcall .+0` is not a call: it is gcc's short way to take three bytes of stack."""
    return instruction.name == "rcall" and instruction.target == instruction.next


def _known(instruction: Instruction) -> int:
    if instruction.target is None:
        raise StackError(
            f"no target known for {instruction.name} {instruction.operands} at {instruction.address:#x}"
        )
    return instruction.target
