// The target of the emulator's C interface: any functions, in any order, with any arguments.
#include "api/private.h"
#include "base_array.h"
#include "targets.h"

#include <cmath>
#include <cstring>
#include <limits>

namespace tilenca {
namespace fuzz {

namespace {

constexpr unsigned kMostCalls = 40;
constexpr unsigned kRoom = 16;
constexpr double kLongestRunS = 0.3e-3;

// Takes arguments out of bytes; 0 where they have ended.
class Source {
  public:
    Source(const uint8_t* bytes, size_t size) : at_(bytes), left_(size) {}

    bool ended() const { return left_ == 0; }
    uint8_t byte() {
        if (left_ == 0) {
            return 0;
        }
        --left_;
        return *at_++;
    }
    // Mostly small, at times as large as can be.
    unsigned number() {
        const uint8_t kind = byte();
        if (kind < 0xC0) {
            return kind & 15u;
        }
        const unsigned low = byte(), high = byte();
        return kind < 0xF0 ? low | high << 8 : ~(low | high << 8);
    }
    double real() {
        constexpr double kSpecial[] = {
            0,   1,    -1,  0.5,  1e-6, 1e6,  -1e6,
            1e9, 5,    1e5, -1e5, 3e-4, -0.0, std::numeric_limits<double>::infinity(),
            NAN, 1e300};
        const uint8_t kind = byte();
        return kSpecial[kind & 15] * (kind >> 4 == 0 ? 1.0 : byte() / 128.0);
    }
    char port() { return static_cast<char>('A' + byte() % 14); }

  private:
    const uint8_t* at_;
    size_t left_;
};

struct Room {
    uint8_t bytes[kRoom] = {}, others[kRoom] = {};
    double times[kRoom] = {};
    uint32_t words[kRoom] = {};
    uint64_t cycles[kRoom] = {};
};

const uint8_t* snapshot_of(tilenca_array* array, size_t* count) {
    const uint8_t* bytes = nullptr;
    const ptrdiff_t got = tilenca_array_save(array, &bytes);
    must(got > 0, "an array that cannot be saved");
    *count = static_cast<size_t>(got);
    return bytes;
}

void lay_cables(tilenca_array* a, Source& in, unsigned tile) {
    const unsigned side = in.number();
    switch (in.byte() % 6) {
    case 0:
        tilenca_array_link(a, tile, side, in.number(), in.number());
        break;
    case 1:
        tilenca_array_unlink(a, tile, side);
        break;
    case 2:
        tilenca_array_connect(a, tile, side, in.byte() & 1);
        break;
    case 3: {
        const tilenca_wire_fault fault = {in.real(), in.real(), in.real(), in.real()};
        tilenca_array_set_fault(a, tile, side, &fault, in.byte());
        break;
    }
    case 4: {
        tilenca_wire_counts counts;
        tilenca_array_fault_counts(a, tile, side, &counts);
        break;
    }
    default:
        tilenca_side_pin(side, in.byte() & 1, nullptr, nullptr);
    }
}

void touch(tilenca_array* a, Source& in, unsigned tile, Room& room) {
    switch (in.byte() % 18) {
    case 0:
        tilenca_tile_set_power(a, tile, in.byte() & 1);
        break;
    case 1:
        tilenca_tile_reset(a, tile, in.number());
        break;
    case 2:
        tilenca_tile_set_drift(a, tile, in.real());
        break;
    case 3:
        tilenca_tile_set_skew(a, tile, in.real());
        break;
    case 4:
        tilenca_tile_set_fuses(a, tile, in.byte(), in.byte(), in.byte(), in.byte());
        break;
    case 5:
        tilenca_tile_send(a, tile, room.bytes, in.byte() % kRoom);
        break;
    case 6:
        tilenca_tile_receive(a, tile, room.bytes, room.times, in.byte() % kRoom);
        break;
    case 7:
        tilenca_tile_display_changes(a, tile, in.number(), room.times, room.bytes, in.byte() % kRoom);
        break;
    case 8:
        tilenca_tile_hold_pin(a, tile, in.port(), in.number(), static_cast<int>(in.byte() % 3) - 1);
        break;
    case 9:
        tilenca_tile_push_edge(a, tile, in.port(), in.number(), in.number(), in.byte() & 1);
        break;
    case 10:
        tilenca_tile_set_analog(a, tile, in.number(), in.number());
        break;
    case 11:
        tilenca_tile_set_supply(a, tile, in.real());
        tilenca_tile_set_adc_noise(a, tile, in.real(), in.byte());
        break;
    case 12:
        tilenca_tile_set_comparator(a, tile, in.number(), in.number());
        tilenca_tile_set_spi_loopback(a, tile, in.byte() & 1);
        break;
    case 13:
        tilenca_tile_pin(a, tile, in.port(), in.number());
        tilenca_tile_duty(a, tile, in.port(), in.number());
        break;
    case 14:
        tilenca_tile_write_memory(a, tile, in.number(), room.bytes, in.byte() % kRoom);
        break;
    case 15:
        tilenca_tile_write_eeprom(a, tile, in.number(), room.bytes, in.byte() % kRoom);
        break;
    case 16:
        tilenca_tile_read_flash(a, tile, in.number(), room.bytes, in.byte() % kRoom);
        break;
    default:
        tilenca_tile_press_button(a, tile, in.byte() & 1);
        tilenca_tile_rgb(a, tile, room.bytes);
        tilenca_tile_leds(a, tile);
        tilenca_tile_segments(a, tile);
        tilenca_tile_fault(a, tile);
        tilenca_tile_warning(a, tile, in.number());
    }
}

void debug(tilenca_array* a, Source& in, unsigned tile, Room& room) {
    switch (in.byte() % 9) {
    case 0:
        tilenca_tile_set_pc(a, tile, in.number());
        break;
    case 1:
        tilenca_tile_set_status(a, tile, in.number());
        break;
    case 2:
        tilenca_tile_set_breakpoint(a, tile, in.number(), in.byte() & 1);
        break;
    case 3:
        tilenca_tile_halt(a, tile);
        break;
    case 4:
        tilenca_tile_step(a, tile);
        break;
    case 5:
        tilenca_tile_resume(a, tile);
        break;
    case 6:
        tilenca_tile_set_mark(a, tile, in.number(), in.byte() & 1);
        tilenca_tile_marks(a, tile, room.words, room.cycles, in.byte() % kRoom);
        break;
    case 7: {
        tilenca_stack stack;
        tilenca_cycles cycles;
        tilenca_tile_stack(a, tile, &stack);
        tilenca_tile_cycles(a, tile, &cycles);
        break;
    }
    default:
        tilenca_probe_new(a, tile, in.port(), in.number(), in.real());
    }
}

void look(tilenca_array* a, Source& in, Room& room) {
    const unsigned probe = in.number();
    tilenca_probe_level(a, probe);
    tilenca_probe_edges(a, probe, room.times, room.bytes, in.byte() % kRoom);
    tilenca_probe_bytes(a, probe, room.times, room.bytes, room.others, in.byte() % kRoom);
    if (in.byte() & 1) {
        tilenca_probe_free(a, probe);
    }
}

void manage(tilenca_array* a, Source& in, std::vector<uint8_t>& kept) {
    switch (in.byte() % 7) {
    case 0:
        if (tilenca_array_size(a) < 6) { // more only take longer
            const double ppm = in.real();
            const double start_s = in.real(); // all the time since then is run first
            tilenca_array_add_tile(a, ppm, start_s);
        }
        break;
    case 1:
        tilenca_array_remove_tile(a, in.number());
        break;
    case 2:
        tilenca_array_set_threads(a, in.number() & 3);
        break;
    case 3: {
        size_t count = 0;
        const uint8_t* bytes = snapshot_of(a, &count);
        kept.assign(bytes, bytes + count);
        break;
    }
    case 4:
        if (!kept.empty()) {
            must(tilenca_array_load(a, kept.data(), kept.size()) == 0, "a snapshot of its own is refused");
        }
        break;
    case 5:
        tilenca_array_set_cable_delay(a, in.real());
        break;
    default: {
        const tilenca_hardware hardware = {in.byte(),     in.real(),     in.byte() & 1,
                                           in.byte() & 1, in.byte() & 1, static_cast<int>(in.number())};
        tilenca_array_set_hardware(a, &hardware);
    }
    }
}

} // namespace

void calls(const uint8_t* bytes, size_t size) {
    Source in(bytes, size);
    const auto delete_array = [](tilenca_array* array) { tilenca_array_free(array); };
    static const Image image = base_image();
    const std::unique_ptr<tilenca_array, decltype(delete_array)> array(
        new tilenca_array{Array(image, avr::Fuses(), {Clock(), Clock(1e-3, 0, 2000)}), {}, {}, {}, {}, {}},
        delete_array);
    std::vector<uint8_t> kept;
    Room room;
    for (unsigned call = 0; call < kMostCalls && !in.ended(); ++call) {
        const uint8_t kind = in.byte();
        const unsigned tile = kind >> 4 == 15 ? in.number() : kind >> 4 & 1;
        switch (kind & 7) {
        case 0:
            lay_cables(array.get(), in, tile);
            break;
        case 1:
        case 2:
            touch(array.get(), in, tile, room);
            break;
        case 3:
            debug(array.get(), in, tile, room);
            break;
        case 4:
            look(array.get(), in, room);
            break;
        case 5:
            manage(array.get(), in, kept);
            break;
        default:
            tilenca_array_run(array.get(), kLongestRunS * in.byte() / 255);
        }
    }
    size_t count = 0;
    const uint8_t* last = snapshot_of(array.get(), &count);
    const std::vector<uint8_t> saved(last, last + count);
    must(tilenca_array_load(array.get(), saved.data(), count) == 0, "the last snapshot is refused");
}

} // namespace fuzz
} // namespace tilenca
