// The array's part of the C interface.
#include "capi_private.h"

#include <algorithm>
#include <cstring>

using tilenca::Array;
using tilenca::capi::fail;

namespace {

thread_local std::string last_error;

tilenca::Clock clock_of(double ppm, double switch_on_s) {
    return tilenca::Clock(ppm * 1e-6, 0, switch_on_s * tilenca::kTicksPerSecond);
}

tilenca::avr::Fuses fuses_of(const tilenca::Image& image, bool with_bootloader) {
    using tilenca::avr::Fuses;
    Fuses fuses = with_bootloader ? Fuses::of_mega_with_bootloader() : Fuses{};
    if (with_bootloader) {
        return fuses;
    }
    uint8_t* const bytes[3] = {&fuses.low, &fuses.high, &fuses.extended};
    for (size_t i = 0; i < std::min<size_t>(3, image.fuses.size()); i++) {
        *bytes[i] = image.fuses[i];
    }
    fuses.lock = image.lock.empty() ? fuses.lock : image.lock[0];
    return fuses;
}

int no_cable(unsigned tile, unsigned side) {
    return fail("no cable at side " + std::to_string(side) + " of tile " + std::to_string(tile));
}

} // namespace

int tilenca::capi::fail(const std::string& message) {
    last_error = message;
    return -1;
}

bool tilenca::capi::find_pin(char port, unsigned bit, avr::PinId* pin) {
    if (port < 'A' || port > 'L' || port == 'I' || bit > 7) {
        fail("no pin P" + std::string(1, port) + std::to_string(bit) +
             "; ports are A to L without I, bits 0 to 7");
        return false;
    }
    *pin = {avr::port_index(port), static_cast<uint8_t>(bit)};
    return true;
}

const char* tilenca_last_error(void) {
    return last_error.c_str();
}

tilenca_array* tilenca_array_new(const char* image, const char* bootloader, unsigned tiles, const double* ppm,
                                 const double* switch_on_s) {
    try {
        tilenca::Image contents = tilenca::load_image(image);
        const tilenca::avr::Fuses fuses = fuses_of(contents, bootloader != nullptr);
        if (bootloader != nullptr) {
            const tilenca::Image boot = tilenca::load_image(bootloader);
            contents.flash.insert(contents.flash.end(), boot.flash.begin(), boot.flash.end());
        }
        std::vector<tilenca::Clock> clocks;
        for (unsigned i = 0; i < tiles; i++) {
            clocks.push_back(clock_of(ppm[i], switch_on_s[i]));
        }
        return new tilenca_array{Array(contents, fuses, clocks), {}, {}, {}, {}};
    } catch (const std::exception& error) {
        fail(error.what());
        return nullptr;
    }
}

void tilenca_array_free(tilenca_array* array) {
    delete array;
}

unsigned tilenca_array_size(tilenca_array* array) {
    return array->array.size();
}

unsigned tilenca_array_add_tile(tilenca_array* array, double ppm, double switch_on_s) {
    return array->array.add_tile(clock_of(ppm, switch_on_s));
}

void tilenca_array_remove_tile(tilenca_array* array, unsigned tile) {
    array->array.remove_tile(tile);
}

int tilenca_array_link(tilenca_array* array, unsigned tile, unsigned side, unsigned other_tile,
                       unsigned other_side) {
    return array->array.link({tile, side}, {other_tile, other_side}) ? 0 : fail("a side has a cable already");
}

int tilenca_array_unlink(tilenca_array* array, unsigned tile, unsigned side) {
    return array->array.unlink({tile, side}) ? 0 : no_cable(tile, side);
}

int tilenca_array_connect(tilenca_array* array, unsigned tile, unsigned side, int connected) {
    return array->array.set_connected({tile, side}, connected != 0) ? 0 : no_cable(tile, side);
}

int tilenca_array_set_fault(tilenca_array* array, unsigned tile, unsigned side, double loss, double flip,
                            double delay_s, double baud, uint64_t seed) {
    tilenca::Wire* wire = array->array.wire_from({tile, side});
    if (wire == nullptr) {
        return no_cable(tile, side);
    }
    wire->set_fault({loss, flip, delay_s * tilenca::kTicksPerSecond, baud}, seed);
    return 0;
}

int tilenca_array_fault_counts(tilenca_array* array, unsigned tile, unsigned side, uint64_t counts[3]) {
    const tilenca::Wire* wire = array->array.wire_from({tile, side});
    if (wire == nullptr) {
        return no_cable(tile, side);
    }
    counts[0] = wire->counts().bytes;
    counts[1] = wire->counts().lost;
    counts[2] = wire->counts().flipped;
    return 0;
}

void tilenca_array_set_threads(tilenca_array* array, unsigned threads) {
    array->array.set_threads(threads);
}

int tilenca_array_run(tilenca_array* array, double seconds) {
    array->array.run_for(seconds * tilenca::kTicksPerSecond);
    int stopped = 0;
    for (unsigned i = 0; i < array->array.size(); i++) {
        stopped += !array->array.tile(i).chip().cpu().fault.empty();
    }
    return stopped;
}

double tilenca_array_time(tilenca_array* array) {
    return array->array.now() / tilenca::kTicksPerSecond;
}

int tilenca_array_halted(tilenca_array* array, unsigned first) {
    for (unsigned i = first; i < array->array.size(); i++) {
        if (array->array.tile(i).chip().cpu().halted) {
            return static_cast<int>(i);
        }
    }
    return -1;
}

size_t tilenca_array_save(tilenca_array* array, const uint8_t** bytes) {
    array->snapshot = array->array.save();
    *bytes = array->snapshot.data();
    return array->snapshot.size();
}

int tilenca_array_load(tilenca_array* array, const uint8_t* bytes, size_t count) {
    try {
        array->array.load(bytes, count);
    } catch (const std::exception& error) {
        return fail(error.what());
    }
    for (auto& eye : array->eyes) { // of tiles that had not been added then
        eye.probe = eye.tile < array->array.size() ? eye.probe : nullptr;
    }
    return 0;
}

int tilenca_array_symbol(tilenca_array* array, const char* name, uint32_t* address, uint32_t* size) {
    const tilenca::Symbol* symbol = array->array.image().find(name);
    if (symbol == nullptr) {
        return fail("the image has no symbol '" + std::string(name) + "'");
    }
    *address = symbol->address;
    *size = symbol->size;
    return 0;
}

const char* tilenca_array_function_at(tilenca_array* array, uint32_t address) {
    array->function = array->array.image().function_at(address);
    return array->function.c_str();
}
