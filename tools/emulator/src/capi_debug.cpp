// The debugger's part of the C interface, and the probes'.
#include "capi_private.h"

#include "avr/ops.h"

using tilenca::capi::fail;
using tilenca::capi::find_pin;

namespace {

tilenca::avr::Chip& chip_of(tilenca_array* array, unsigned tile) {
    return array->array.tile(tile).chip();
}

bool is_code(uint32_t address) {
    if (address % 2 != 0 || address >= tilenca::avr::kFlashBytes) {
        fail("no instruction begins at flash address " + std::to_string(address));
        return false;
    }
    return true;
}

tilenca::Probe* probe_of(tilenca_array* array, unsigned probe) {
    return probe < array->eyes.size() ? array->eyes[probe].probe : nullptr;
}

} // namespace

void tilenca_tile_stack(tilenca_array* array, unsigned tile, unsigned addresses[3]) {
    const auto& cpu = chip_of(array, tile).cpu();
    addresses[0] = tilenca::avr::ops::pair(&cpu, tilenca::avr::ops::kStackPointer);
    addresses[1] = cpu.stack_deepest;
    addresses[2] = cpu.stack_floor;
}

uint32_t tilenca_tile_pc(tilenca_array* array, unsigned tile) {
    return 2 * chip_of(array, tile).cpu().pc();
}

void tilenca_tile_set_pc(tilenca_array* array, unsigned tile, uint32_t address) {
    auto& cpu = chip_of(array, tile).cpu();
    cpu.at = cpu.program + address / 2 % tilenca::avr::kFlashWords;
}

unsigned tilenca_tile_status(tilenca_array* array, unsigned tile) {
    return chip_of(array, tile).cpu().status();
}

void tilenca_tile_set_status(tilenca_array* array, unsigned tile, unsigned value) {
    chip_of(array, tile).cpu().set_status(static_cast<uint8_t>(value));
}

int tilenca_tile_set_breakpoint(tilenca_array* array, unsigned tile, uint32_t address, int set) {
    if (!is_code(address)) {
        return -1;
    }
    chip_of(array, tile).set_breakpoint(address / 2, set != 0);
    return 0;
}

void tilenca_tile_halt(tilenca_array* array, unsigned tile) {
    chip_of(array, tile).cpu().halted = true;
}

// The others go on until they have caught up, so that nobody hears of what has not happened yet.
int tilenca_tile_step(tilenca_array* array, unsigned tile) {
    auto& chip = chip_of(array, tile);
    auto& cpu = chip.cpu();
    if (chip.is_trapped()) {
        chip.step_halted();
        cpu.halted = true;
        return 1;
    }
    const double patience = array->array.now() + tilenca::kTicksPerSecond;
    cpu.halted = false;
    cpu.halts_after_one = true;
    while (!array->array.has_halted() && cpu.fault.empty() && array->array.now() < patience) {
        array->array.run_for(tilenca::kQuantumTicks);
    }
    const bool stepped = cpu.halted;
    cpu.halts_after_one = false;
    cpu.halted = true;
    return stepped;
}

void tilenca_tile_resume(tilenca_array* array, unsigned tile) {
    auto& chip = chip_of(array, tile);
    if (chip.cpu().halted) {
        chip.step_halted();
    }
    chip.cpu().halted = false;
}

int tilenca_tile_set_mark(tilenca_array* array, unsigned tile, uint32_t address, int set) {
    if (!is_code(address)) {
        return -1;
    }
    chip_of(array, tile).set_mark(address / 2, set != 0);
    return 0;
}

size_t tilenca_tile_marks(tilenca_array* array, unsigned tile, uint32_t* addresses, uint64_t* cycles,
                          size_t room) {
    auto& passed = chip_of(array, tile).marks_passed();
    const size_t count = std::min(room, passed.size());
    for (size_t i = 0; i < count; i++) {
        addresses[i] = 2 * passed[i].word;
        cycles[i] = passed[i].cycle;
    }
    passed.erase(passed.begin(), passed.begin() + static_cast<std::ptrdiff_t>(count));
    return count;
}

// --- probes ---

void tilenca_side_pin(unsigned side, int receives, char* port, unsigned* bit) {
    const tilenca::avr::PinId pin =
        receives != 0 ? tilenca::Tile::receive_pin(side) : tilenca::Tile::transmit_pin(side);
    *port = "ABCDEFGHJKL"[pin.port];
    *bit = pin.bit;
}

int tilenca_probe_new(tilenca_array* array, unsigned tile, char port, unsigned bit, double baud) {
    tilenca::avr::PinId pin;
    if (!find_pin(port, bit, &pin)) {
        return -1;
    }
    tilenca::Probe& probe = array->array.tile(tile).add_probe(pin);
    if (baud >= 0) {
        probe.read_bytes(baud);
    }
    array->eyes.push_back({tile, &probe});
    return static_cast<int>(array->eyes.size()) - 1;
}

void tilenca_probe_free(tilenca_array* array, unsigned probe) {
    if (tilenca::Probe* there = probe_of(array, probe); there != nullptr) {
        array->array.tile(array->eyes[probe].tile).remove_probe(*there);
        array->eyes[probe].probe = nullptr;
    }
}

int tilenca_probe_level(tilenca_array* array, unsigned probe) {
    const tilenca::Probe* there = probe_of(array, probe);
    return there != nullptr && there->level();
}

size_t tilenca_probe_edges(tilenca_array* array, unsigned probe, double* times, uint8_t* levels,
                           size_t room) {
    tilenca::Probe* there = probe_of(array, probe);
    size_t taken = 0;
    for (; there != nullptr && taken < room && !there->edges().empty(); taken++) {
        times[taken] = there->edges().front().ticks / tilenca::kTicksPerSecond;
        levels[taken] = there->edges().front().level;
        there->note_taken(there->edges().front());
        there->edges().pop_front();
    }
    return taken;
}

size_t tilenca_probe_bytes(tilenca_array* array, unsigned probe, double* times, uint8_t* values,
                           uint8_t* framing_errors, size_t room) {
    tilenca::Probe* there = probe_of(array, probe);
    size_t taken = 0;
    for (; there != nullptr && taken < room && !there->receiver().received().empty(); taken++) {
        const auto& byte = there->receiver().received().front();
        times[taken] = byte.ticks / tilenca::kTicksPerSecond;
        values[taken] = byte.value;
        framing_errors[taken] = byte.framing_error;
        there->receiver().received().pop_front();
    }
    return taken;
}
