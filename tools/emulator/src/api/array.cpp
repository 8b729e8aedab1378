// The array's part of the C interface.
#include "api/private.h"

#include <algorithm>
#include <cmath>

using namespace tilenca::c_api;

namespace {

constexpr unsigned kMostThreads = 1024;
constexpr double kLongestRunS = 1e9;
constexpr double kMostWatchdogError = 0.5;

tilenca::avr::Fuses fuses_of(const tilenca::Image& image, bool with_bootloader) {
    using tilenca::avr::Fuses;
    if (with_bootloader) {
        return Fuses::of_mega_with_bootloader();
    }
    Fuses fuses;
    uint8_t* const bytes[3] = {&fuses.low, &fuses.high, &fuses.extended};
    for (size_t i = 0; i < std::min<size_t>(3, image.fuses.size()); i++) {
        *bytes[i] = image.fuses[i];
    }
    fuses.lock = image.lock.empty() ? fuses.lock : image.lock[0];
    return fuses;
}

tilenca_array* new_array(const char* image, const char* bootloader, unsigned tiles, const double* ppm,
                         const double* switch_on_s) {
    check_range("the number of tiles", tiles, 1u, tilenca::kMostTiles);
    tilenca::Image contents = tilenca::load_image(&present(image, "the image's path"));
    const tilenca::avr::Fuses fuses = fuses_of(contents, bootloader != nullptr);
    if (bootloader != nullptr) {
        const tilenca::Image boot = tilenca::load_image(bootloader);
        contents.flash.insert(contents.flash.end(), boot.flash.begin(), boot.flash.end());
    }
    present(ppm, "the list of clock errors");
    present(switch_on_s, "the list of switch-on times");
    std::vector<tilenca::Clock> clocks;
    for (unsigned i = 0; i < tiles; i++) {
        clocks.push_back(clock_of(ppm[i], switch_on_s[i]));
    }
    return new tilenca_array{tilenca::Array(contents, fuses, clocks), {}, {}, {}, {}, {}};
}

} // namespace

tilenca_array* tilenca_array_new(const char* image, const char* bootloader, unsigned tiles, const double* ppm,
                                 const double* switch_on_s) {
    return guarded<tilenca_array*>(nullptr,
                                   [&] { return new_array(image, bootloader, tiles, ppm, switch_on_s); });
}

void tilenca_array_free(tilenca_array* array) {
    delete array;
}

int tilenca_array_size(tilenca_array* array) {
    return guarded(-1, [&] { return static_cast<int>(array_of(array).size()); });
}

int tilenca_array_add_tile(tilenca_array* array, double ppm, double switch_on_s) {
    return guarded(-1, [&] {
        check_range("the number of tiles", array_of(array).size() + 1, 1u, tilenca::kMostTiles);
        return static_cast<int>(array_of(array).add_tile(clock_of(ppm, switch_on_s)));
    });
}

int tilenca_array_remove_tile(tilenca_array* array, unsigned tile) {
    return attempted([&] {
        tile_of(array, tile);
        array->array.remove_tile(tile);
    });
}

int tilenca_array_set_cable_delay(tilenca_array* array, double seconds) {
    return attempted([&] {
        const double ticks = std::round(seconds * tilenca::kTicksPerSecond);
        check_range("a cable's delay in ticks of 16 MHz", ticks, tilenca::kLeastDelayTicks,
                    tilenca::kMostDelayTicks);
        if (!array_of(array).set_cable_delay(ticks)) {
            throw Refusal("cables keep their delay once the array runs");
        }
    });
}

int tilenca_array_set_hardware(tilenca_array* array, const tilenca_hardware* hardware) {
    return attempted([&] {
        const tilenca_hardware& given = present(hardware, "the hardware");
        check_range("the watchdog's error", given.watchdog_error, 0.0, kMostWatchdogError);
        check_range("what a tile without power does", given.unpowered, int{TILENCA_PULLS_LOW},
                    int{TILENCA_LEAVES_OPEN});
        constexpr tilenca::avr::Drive kDrives[] = {tilenca::avr::Drive::Low, tilenca::avr::Drive::Middle,
                                                   tilenca::avr::Drive::High, tilenca::avr::Drive::Open};
        const tilenca::avr::Hardware wanted{given.seed, given.floating_inputs != 0, given.sram_noise != 0,
                                            given.start_up != 0, given.watchdog_error};
        if (!array_of(array).set_hardware(wanted, kDrives[given.unpowered])) {
            throw Refusal("tiles keep their hardware once they have cables or run");
        }
    });
}

int tilenca_array_set_threads(tilenca_array* array, unsigned threads) {
    return attempted([&] {
        check_range("the number of threads", threads, 1u, kMostThreads);
        array_of(array).set_threads(threads);
    });
}

int tilenca_array_run(tilenca_array* array, double seconds) {
    return guarded(-1, [&] {
        check_range("a time to run", seconds, 0.0, kLongestRunS);
        array_of(array).run_for(seconds * tilenca::kTicksPerSecond);
        int stopped = 0;
        for (unsigned i = 0; i < array->array.size(); i++) {
            stopped += !array->array.tile(i).chip().cpu().fault.empty();
        }
        return stopped;
    });
}

double tilenca_array_time(tilenca_array* array) {
    return guarded(-1.0, [&] { return array_of(array).now() / tilenca::kTicksPerSecond; });
}

ptrdiff_t tilenca_array_save(tilenca_array* array, const uint8_t** bytes) {
    return guarded<ptrdiff_t>(-1, [&] {
        present(bytes, "the place for the snapshot's address");
        array->snapshot = array_of(array).save();
        *bytes = array->snapshot.data();
        return static_cast<ptrdiff_t>(array->snapshot.size());
    });
}

int tilenca_array_load(tilenca_array* array, const uint8_t* bytes, size_t count) {
    const int done = attempted([&] { array_of(array).load(&present(bytes, "the snapshot"), count); });
    if (array != nullptr) {
        for (auto& eye : array->eyes) { // of tiles that are no more
            eye.probe = eye.tile < array->array.size() ? eye.probe : nullptr;
        }
    }
    return done;
}

int tilenca_array_symbol(tilenca_array* array, const char* name, uint32_t* address, uint32_t* size) {
    return attempted([&] {
        const tilenca::Symbol* symbol = array_of(array).image().find(&present(name, "the symbol's name"));
        if (symbol == nullptr) {
            throw Refusal("the image has no symbol '" + std::string(name) + "'");
        }
        present(address, "the place for the address") = symbol->address;
        present(size, "the place for the size") = symbol->size;
    });
}

const char* tilenca_array_function_at(tilenca_array* array, uint32_t address) {
    return guarded<const char*>(nullptr, [&] {
        array->function = array_of(array).image().function_at(address);
        return array->function.c_str();
    });
}

// --- translated blocks ---

int tilenca_array_count_instructions(tilenca_array* array) {
    return attempted([&] {
        if (array_of(array).now() > 0) {
            throw Refusal("instructions are counted from the array's beginning, or not at all");
        }
        array_of(array).count_instructions();
    });
}

const char* tilenca_array_translated(tilenca_array* array) {
    return guarded<const char*>(nullptr, [&] {
        array_of(array);
        array->translated = array->array.translated();
        if (array->translated.empty()) {
            throw Refusal("the array's instructions are not counted");
        }
        return array->translated.c_str();
    });
}

int tilenca_array_use_translation(tilenca_array* array, const char* path) {
    return attempted([&] {
        if (!array_of(array).use_translation(path)) {
            const std::string name = path == nullptr ? "the emulator's own blocks" : path;
            throw Refusal(name + ": a translation of another image");
        }
    });
}

// --- cables ---

namespace {

[[noreturn]] void refuse_cable(unsigned tile, unsigned side) {
    throw Refusal("no cable at side " + std::to_string(side) + " of tile " + std::to_string(tile));
}

tilenca::Wire& wire_from(tilenca_array* array, unsigned tile, unsigned side) {
    tilenca::Wire* wire = array_of(array).wire_from(end_of(array, tile, side));
    if (wire == nullptr) {
        refuse_cable(tile, side);
    }
    return *wire;
}

} // namespace

int tilenca_array_link(tilenca_array* array, unsigned tile, unsigned side, unsigned other_tile,
                       unsigned other_side) {
    return attempted([&] {
        const tilenca::Array::End one = end_of(array, tile, side);
        const tilenca::Array::End other = end_of(array, other_tile, other_side);
        if (tile == other_tile) {
            throw Refusal("a cable joins two tiles");
        }
        if (!array_of(array).link(one, other)) {
            throw Refusal("a side has a cable already");
        }
    });
}

int tilenca_array_unlink(tilenca_array* array, unsigned tile, unsigned side) {
    return attempted([&] {
        if (!array_of(array).unlink(end_of(array, tile, side))) {
            refuse_cable(tile, side);
        }
    });
}

int tilenca_array_connect(tilenca_array* array, unsigned tile, unsigned side, int connected) {
    return attempted([&] {
        if (!array_of(array).set_connected(end_of(array, tile, side), connected != 0)) {
            refuse_cable(tile, side);
        }
    });
}

int tilenca_array_set_fault(tilenca_array* array, unsigned tile, unsigned side,
                            const tilenca_wire_fault* fault, uint64_t seed) {
    return attempted([&] {
        const tilenca_wire_fault& given = present(fault, "the fault");
        check_range("loss", given.loss, 0.0, 1.0);
        check_range("flip", given.flip, 0.0, 1.0);
        check_range("delay_s", given.delay_s, 0.0, 1.0);
        check_range("baud", given.baud, 0.0, 1e9);
        wire_from(array, tile, side)
            .set_fault({given.loss, given.flip, given.delay_s * tilenca::kTicksPerSecond, given.baud}, seed);
    });
}

int tilenca_array_fault_counts(tilenca_array* array, unsigned tile, unsigned side,
                               tilenca_wire_counts* counts) {
    return attempted([&] {
        const tilenca::Wire::Counts& found = wire_from(array, tile, side).counts();
        present(counts, "the place for the counts") = {found.bytes, found.lost, found.flipped};
    });
}
