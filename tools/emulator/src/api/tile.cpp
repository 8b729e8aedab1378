// A tile's part of the C interface: what people see and touch, and its memories.
#include "api/private.h"

#include <algorithm>

using namespace tilenca::c_api;

const char* tilenca_tile_fault(tilenca_array* array, unsigned tile) {
    return guarded<const char*>(nullptr, [&] {
        tile_of(array, tile);
        array->faults.resize(array->array.size());
        array->faults[tile] = array->array.fault(tile);
        return array->faults[tile].c_str();
    });
}

int tilenca_tile_warnings(tilenca_array* array, unsigned tile) {
    return guarded(-1,
                   [&] { return static_cast<int>(tile_of(array, tile).chip().warnings().list().size()); });
}

const char* tilenca_tile_warning(tilenca_array* array, unsigned tile, unsigned index) {
    return guarded<const char*>(nullptr, [&] {
        const auto& list = tile_of(array, tile).chip().warnings().list();
        check_index("warning", index, static_cast<long long>(list.size()));
        return list[index].c_str();
    });
}

int tilenca_tile_segments(tilenca_array* array, unsigned tile) {
    return guarded(-1, [&] { return int{tile_of(array, tile).segments()}; });
}

ptrdiff_t tilenca_tile_display_changes(tilenca_array* array, unsigned tile, size_t first, double* times,
                                       uint8_t* segments, size_t room) {
    return guarded<ptrdiff_t>(-1, [&] {
        const auto& changes = tile_of(array, tile).display_changes();
        for (size_t i = first; i < changes.size() && i - first < room; i++) {
            (&present(times, "the room for times"))[i - first] = changes[i].ticks / tilenca::kTicksPerSecond;
            (&present(segments, "the room for segments"))[i - first] = changes[i].segments;
        }
        return static_cast<ptrdiff_t>(changes.size());
    });
}

int tilenca_tile_leds(tilenca_array* array, unsigned tile) {
    return guarded(-1, [&] { return int{tile_of(array, tile).leds()}; });
}

int tilenca_tile_rgb(tilenca_array* array, unsigned tile, uint8_t duty[3]) {
    return attempted([&] { tile_of(array, tile).colour(&present(duty, "the room for the duty")); });
}

int tilenca_tile_press_button(tilenca_array* array, unsigned tile, int pressed) {
    return attempted([&] { tile_of(array, tile).press_button(pressed != 0); });
}

int tilenca_tile_reset(tilenca_array* array, unsigned tile, unsigned cause) {
    return attempted([&] {
        if (cause != TILENCA_RESET_EXTERNAL && cause != TILENCA_RESET_BROWN_OUT) {
            throw Refusal("no cause of a reset from outside: " + std::to_string(cause));
        }
        if (tile_of(array, tile).is_powered()) {
            tile_of(array, tile).chip().reset(static_cast<tilenca::avr::ResetCause>(cause));
        }
    });
}

int tilenca_tile_set_power(tilenca_array* array, unsigned tile, int on) {
    return attempted([&] {
        tile_of(array, tile);
        array->array.set_power(tile, on != 0);
    });
}

int tilenca_tile_is_powered(tilenca_array* array, unsigned tile) {
    return guarded(-1, [&] { return int{tile_of(array, tile).is_powered()}; });
}

int tilenca_tile_set_drift(tilenca_array* array, unsigned tile, double ppm_per_s) {
    return attempted([&] {
        check_range("a drift in ppm per second", ppm_per_s, -1e6, 1e6);
        tile_of(array, tile).clock().set_drift(ppm_per_s * 1e-6, array->array.now());
    });
}

int tilenca_tile_set_skew(tilenca_array* array, unsigned tile, double ppm) {
    return attempted([&] {
        check_range("a clock's skew in ppm", ppm, -1e5, 1e5);
        tile_of(array, tile).clock().set_skew(ppm * 1e-6, array->array.now());
    });
}

int tilenca_tile_set_fuses(tilenca_array* array, unsigned tile, unsigned low, unsigned high,
                           unsigned extended, unsigned lock) {
    return attempted([&] {
        for (const unsigned byte : {low, high, extended, lock}) {
            check_range("a fuse or lock byte", byte, 0u, 0xFFu);
        }
        auto& chip = tile_of(array, tile).chip();
        chip.fuses() = {static_cast<uint8_t>(low), static_cast<uint8_t>(high), static_cast<uint8_t>(extended),
                        static_cast<uint8_t>(lock)};
        chip.reset(tilenca::avr::ResetCause::PowerOn);
    });
}

int tilenca_tile_send(tilenca_array* array, unsigned tile, const uint8_t* bytes, size_t count) {
    return attempted([&] {
        auto& host = tile_of(array, tile).host();
        for (size_t i = 0; i < count; i++) {
            host.send((&present(bytes, "the bytes to send"))[i]);
        }
    });
}

ptrdiff_t tilenca_tile_receive(tilenca_array* array, unsigned tile, uint8_t* bytes, double* times,
                               size_t room) {
    return guarded<ptrdiff_t>(-1, [&] {
        auto& received = tile_of(array, tile).host().received();
        size_t taken = 0;
        for (; taken < room && !received.empty(); taken++) {
            (&present(bytes, "the room for bytes"))[taken] = received.front().value;
            (&present(times, "the room for times"))[taken] =
                received.front().ticks / tilenca::kTicksPerSecond;
            received.pop_front();
        }
        return static_cast<ptrdiff_t>(taken);
    });
}

// --- memories ---

namespace {

void check_memory(const char* what, size_t limit, unsigned address, const uint8_t* bytes, unsigned count) {
    if (address > limit || count > limit - address) {
        throw Refusal(std::string(what) + " address " + std::to_string(address) + " + " +
                      std::to_string(count) + " ends beyond " + std::to_string(limit));
    }
    if (count != 0) {
        present(bytes, "the room for bytes");
    }
}

} // namespace

int tilenca_tile_read_eeprom(tilenca_array* array, unsigned tile, unsigned address, uint8_t* bytes,
                             unsigned count) {
    return attempted([&] {
        const auto& memory = tile_of(array, tile).chip().eeprom().memory();
        check_memory("EEPROM", memory.size(), address, bytes, count);
        std::copy_n(memory.begin() + address, count, bytes);
    });
}

int tilenca_tile_write_eeprom(tilenca_array* array, unsigned tile, unsigned address, const uint8_t* bytes,
                              unsigned count) {
    return attempted([&] {
        auto& memory = tile_of(array, tile).chip().eeprom().memory();
        check_memory("EEPROM", memory.size(), address, bytes, count);
        std::copy_n(bytes, count, memory.begin() + address);
    });
}

int tilenca_tile_read_memory(tilenca_array* array, unsigned tile, unsigned address, uint8_t* bytes,
                             unsigned count) {
    return attempted([&] {
        const auto& cpu = tile_of(array, tile).chip().cpu();
        check_memory("data", tilenca::avr::kDataBytes, address, bytes, count);
        std::copy_n(cpu.data + address, count, bytes);
    });
}

int tilenca_tile_write_memory(tilenca_array* array, unsigned tile, unsigned address, const uint8_t* bytes,
                              unsigned count) {
    return attempted([&] {
        auto& cpu = tile_of(array, tile).chip().cpu();
        check_memory("data", tilenca::avr::kDataBytes, address, bytes, count);
        std::copy_n(bytes, count, cpu.data + address);
    });
}

int tilenca_tile_read_flash(tilenca_array* array, unsigned tile, unsigned address, uint8_t* bytes,
                            unsigned count) {
    return attempted([&] {
        const uint8_t* flash = tile_of(array, tile).chip().flash();
        check_memory("flash", tilenca::avr::kFlashBytes, address, bytes, count);
        std::copy_n(flash + address, count, bytes);
    });
}
