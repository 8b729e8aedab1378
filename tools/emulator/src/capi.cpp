#include "capi.h"

#include "array/array.h"

#include <algorithm>
#include <cstring>

using tilenca::Array;

struct tilenca_array {
    Array array;
    std::vector<std::string> faults; // what tilenca_tile_fault gives out must live on
};

namespace {

thread_local std::string last_error;

bool find_pin(char port, unsigned bit, tilenca::avr::PinId* pin) {
    if (port < 'A' || port > 'L' || port == 'I' || bit > 7) {
        last_error = "no pin P" + std::string(1, port) + std::to_string(bit) +
                     "; ports are A to L without I, bits 0 to 7";
        return false;
    }
    *pin = {tilenca::avr::port_index(port), static_cast<uint8_t>(bit)};
    return true;
}

int copy_out(const uint8_t* from, unsigned limit, unsigned address, uint8_t* bytes, unsigned count) {
    if (address > limit || count > limit - address) {
        last_error = "address " + std::to_string(address) + " + " + std::to_string(count) + " ends beyond " +
                     std::to_string(limit);
        return -1;
    }
    std::memcpy(bytes, from + address, count);
    return 0;
}

} // namespace

const char* tilenca_last_error(void) {
    return last_error.c_str();
}

tilenca_array* tilenca_array_new(const char* image, const char* bootloader, unsigned tiles, const double* ppm,
                                 const double* switch_on_s) {
    try {
        tilenca::Image contents = tilenca::load_image(image);
        if (bootloader != nullptr) {
            const tilenca::Image boot = tilenca::load_image(bootloader);
            contents.flash.insert(contents.flash.end(), boot.flash.begin(), boot.flash.end());
        }
        std::vector<tilenca::Clock> clocks;
        for (unsigned i = 0; i < tiles; i++) {
            clocks.push_back({1 + ppm[i] * 1e-6, switch_on_s[i] * tilenca::kTicksPerSecond});
        }
        return new tilenca_array{Array(contents, {bootloader != nullptr}, clocks),
                                 std::vector<std::string>(tiles)};
    } catch (const std::exception& error) {
        last_error = error.what();
        return nullptr;
    }
}

void tilenca_array_free(tilenca_array* array) {
    delete array;
}

int tilenca_array_link(tilenca_array* array, unsigned tile, unsigned side, unsigned other_tile,
                       unsigned other_side) {
    array->array.link({tile, side, other_tile, other_side});
    return 0;
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

const char* tilenca_tile_fault(tilenca_array* array, unsigned tile) {
    array->faults[tile] = array->array.fault(tile);
    return array->faults[tile].c_str();
}

const char* tilenca_tile_warning(tilenca_array* array, unsigned tile, unsigned index) {
    const auto& list = array->array.tile(tile).chip().warnings().list();
    return index < list.size() ? list[index].c_str() : nullptr;
}

int tilenca_tile_segments(tilenca_array* array, unsigned tile) {
    return array->array.tile(tile).segments();
}

int tilenca_tile_leds(tilenca_array* array, unsigned tile) {
    return array->array.tile(tile).leds();
}

void tilenca_tile_rgb(tilenca_array* array, unsigned tile, uint8_t duty[3]) {
    array->array.tile(tile).colour(duty);
}

void tilenca_tile_press_button(tilenca_array* array, unsigned tile, int pressed) {
    array->array.tile(tile).press_button(pressed != 0);
}

void tilenca_tile_reset(tilenca_array* array, unsigned tile) {
    array->array.tile(tile).chip().reset(tilenca::avr::ResetCause::External);
}

int tilenca_tile_pin(tilenca_array* array, unsigned tile, char port, unsigned bit) {
    auto& chip = array->array.tile(tile).chip();
    tilenca::avr::PinId pin;
    return find_pin(port, bit, &pin) ? chip.gpio().level(pin, chip.cpu().cycle) : -1;
}

double tilenca_tile_duty(tilenca_array* array, unsigned tile, char port, unsigned bit) {
    tilenca::avr::PinId pin;
    return find_pin(port, bit, &pin) ? array->array.tile(tile).chip().duty(pin) : -1;
}

int tilenca_tile_hold_pin(tilenca_array* array, unsigned tile, char port, unsigned bit, int level) {
    auto& chip = array->array.tile(tile).chip();
    tilenca::avr::PinId pin;
    if (!find_pin(port, bit, &pin)) {
        return -1;
    }
    chip.gpio().hold_input(pin, level != 0, chip.cpu().cycle);
    return 0;
}

void tilenca_tile_set_analog(tilenca_array* array, unsigned tile, unsigned channel, unsigned value) {
    array->array.tile(tile).chip().adc().set_input(channel, static_cast<uint16_t>(value));
}

int tilenca_tile_push_edge(tilenca_array* array, unsigned tile, char port, unsigned bit, uint64_t cycle,
                           int level) {
    auto& chip = array->array.tile(tile).chip();
    tilenca::avr::PinId pin;
    if (!find_pin(port, bit, &pin)) {
        return -1;
    }
    if (chip.gpio().line(pin) == nullptr) {
        chip.gpio().attach_line(pin);
    }
    chip.push_edge(pin, cycle, level != 0);
    return 0;
}

void tilenca_tile_send(tilenca_array* array, unsigned tile, const uint8_t* bytes, size_t count) {
    for (size_t i = 0; i < count; i++) {
        array->array.tile(tile).host().send(bytes[i]);
    }
}

size_t tilenca_tile_receive(tilenca_array* array, unsigned tile, uint8_t* bytes, double* times, size_t room) {
    auto& received = array->array.tile(tile).host().received();
    size_t taken = 0;
    for (; taken < room && !received.empty(); taken++) {
        bytes[taken] = received.front().value;
        times[taken] = received.front().ticks / tilenca::kTicksPerSecond;
        received.pop_front();
    }
    return taken;
}

size_t tilenca_tile_display_changes(tilenca_array* array, unsigned tile, size_t first, double* times,
                                    uint8_t* segments, size_t room) {
    const auto& changes = array->array.tile(tile).display_changes();
    for (size_t i = first; i < changes.size() && i - first < room; i++) {
        times[i - first] = changes[i].ticks / tilenca::kTicksPerSecond;
        segments[i - first] = changes[i].segments;
    }
    return changes.size();
}

int tilenca_tile_read_eeprom(tilenca_array* array, unsigned tile, unsigned address, uint8_t* bytes,
                             unsigned count) {
    const auto& memory = array->array.tile(tile).chip().eeprom().memory();
    return copy_out(memory.data(), tilenca::avr::kEepromBytes, address, bytes, count);
}

int tilenca_tile_write_eeprom(tilenca_array* array, unsigned tile, unsigned address, const uint8_t* bytes,
                              unsigned count) {
    auto& memory = array->array.tile(tile).chip().eeprom().memory();
    if (address > memory.size() || count > memory.size() - address) {
        last_error = "EEPROM address beyond 4095";
        return -1;
    }
    std::copy(bytes, bytes + count, memory.begin() + address);
    return 0;
}

int tilenca_tile_read_memory(tilenca_array* array, unsigned tile, unsigned address, uint8_t* bytes,
                             unsigned count) {
    const auto& cpu = array->array.tile(tile).chip().cpu();
    return copy_out(cpu.data, tilenca::avr::kDataBytes, address, bytes, count);
}

int tilenca_tile_read_flash(tilenca_array* array, unsigned tile, unsigned address, uint8_t* bytes,
                            unsigned count) {
    const auto& chip = array->array.tile(tile).chip();
    return copy_out(chip.flash(), tilenca::avr::kFlashBytes, address, bytes, count);
}

void tilenca_tile_cycles(tilenca_array* array, unsigned tile, uint64_t* total, uint64_t* asleep) {
    const auto& cpu = array->array.tile(tile).chip().cpu();
    *total = cpu.cycle;
    *asleep = cpu.sleep_cycles;
}

uint32_t tilenca_tile_pc(tilenca_array* array, unsigned tile) {
    return 2 * array->array.tile(tile).chip().cpu().pc();
}
