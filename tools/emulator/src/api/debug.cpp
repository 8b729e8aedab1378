// The part of the C interface for measuring and debugging.
#include "api/private.h"

#include "avr/ops.h"

#include <algorithm>

using namespace tilenca::c_api;

namespace {

tilenca::avr::Chip& chip_of(tilenca_array* array, unsigned tile) {
    return tile_of(array, tile).chip();
}

// The number of a word of flash.
uint32_t word_of(uint32_t address) {
    if (address % 2 != 0 || address >= tilenca::avr::kFlashBytes) {
        throw Refusal("no instruction begins at flash address " + std::to_string(address));
    }
    return address / 2;
}

// Whether the tile stepped. The others go on until they have caught up, so that nobody hears of what has not
// happened yet.
bool step(tilenca::Array& array, tilenca::avr::Chip& chip) {
    auto& cpu = chip.cpu();
    if (chip.is_trapped()) {
        chip.step_halted();
        cpu.halted = true;
        return true;
    }
    const double patience = array.now() + tilenca::kTicksPerSecond;
    cpu.halted = false;
    cpu.halts_after_one = true;
    while (!array.has_halted() && cpu.fault.empty() && array.now() < patience) {
        array.run_for(tilenca::kQuantumTicks);
    }
    const bool stepped = cpu.halted;
    cpu.halts_after_one = false;
    cpu.halted = true;
    return stepped;
}

} // namespace

int tilenca_tile_cycles(tilenca_array* array, unsigned tile, tilenca_cycles* cycles) {
    return attempted([&] {
        const auto& cpu = chip_of(array, tile).cpu();
        present(cycles, "the place for the cycles") = {cpu.cycle, cpu.sleep_cycles,
                                                       tile_of(array, tile).cycles_off()};
    });
}

int tilenca_tile_stack(tilenca_array* array, unsigned tile, tilenca_stack* stack) {
    return attempted([&] {
        const auto& cpu = chip_of(array, tile).cpu();
        const uint32_t pointer = tilenca::avr::ops::pair(&cpu, tilenca::avr::ops::kStackPointer);
        present(stack, "the place for the stack") = {pointer, cpu.stack_deepest, cpu.stack_floor};
    });
}

int tilenca_tile_pc(tilenca_array* array, unsigned tile) {
    return guarded(-1, [&] { return static_cast<int>(2 * chip_of(array, tile).cpu().pc()); });
}

int tilenca_tile_set_pc(tilenca_array* array, unsigned tile, uint32_t address) {
    return attempted([&] {
        auto& cpu = chip_of(array, tile).cpu();
        cpu.at = cpu.program + word_of(address);
    });
}

int tilenca_tile_status(tilenca_array* array, unsigned tile) {
    return guarded(-1, [&] { return int{chip_of(array, tile).cpu().status()}; });
}

int tilenca_tile_set_status(tilenca_array* array, unsigned tile, unsigned value) {
    return attempted([&] {
        check_range("SREG", value, 0u, 0xFFu);
        chip_of(array, tile).cpu().set_status(static_cast<uint8_t>(value));
    });
}

int tilenca_tile_set_breakpoint(tilenca_array* array, unsigned tile, uint32_t address, int set) {
    return attempted([&] { chip_of(array, tile).set_breakpoint(word_of(address), set != 0); });
}

int tilenca_tile_is_halted(tilenca_array* array, unsigned tile) {
    return guarded(-1, [&] { return int{chip_of(array, tile).cpu().halted}; });
}

int tilenca_tile_halt(tilenca_array* array, unsigned tile) {
    return attempted([&] { chip_of(array, tile).cpu().halted = true; });
}

int tilenca_tile_step(tilenca_array* array, unsigned tile) {
    return guarded(-1, [&] { return int{step(array_of(array), chip_of(array, tile))}; });
}

int tilenca_tile_resume(tilenca_array* array, unsigned tile) {
    return attempted([&] {
        auto& chip = chip_of(array, tile);
        if (chip.cpu().halted) {
            chip.step_halted();
        }
        chip.cpu().halted = false;
    });
}

int tilenca_tile_set_mark(tilenca_array* array, unsigned tile, uint32_t address, int set) {
    return attempted([&] { chip_of(array, tile).set_mark(word_of(address), set != 0); });
}

ptrdiff_t tilenca_tile_marks(tilenca_array* array, unsigned tile, uint32_t* addresses, uint64_t* cycles,
                             size_t room) {
    return guarded<ptrdiff_t>(-1, [&] {
        auto& passed = chip_of(array, tile).marks_passed();
        const auto count = static_cast<ptrdiff_t>(std::min(room, passed.size()));
        for (ptrdiff_t i = 0; i < count; i++) {
            (&present(addresses, "the room for addresses"))[i] = 2 * passed[i].word;
            (&present(cycles, "the room for cycles"))[i] = passed[i].cycle;
        }
        passed.erase(passed.begin(), passed.begin() + count);
        return count;
    });
}
