// A tile's part of the C interface: what eyes, fingers and cables reach, and its memories.
#include "capi_private.h"

#include <algorithm>
#include <cstring>

using tilenca::capi::fail;
using tilenca::capi::find_pin;

namespace {

int copy_out(const uint8_t* from, unsigned limit, unsigned address, uint8_t* bytes, unsigned count) {
    if (address > limit || count > limit - address) {
        return fail("address " + std::to_string(address) + " + " + std::to_string(count) + " ends beyond " +
                    std::to_string(limit));
    }
    std::memcpy(bytes, from + address, count);
    return 0;
}

} // namespace

const char* tilenca_tile_fault(tilenca_array* array, unsigned tile) {
    array->faults.resize(array->array.size());
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

void tilenca_tile_reset(tilenca_array* array, unsigned tile, unsigned cause) {
    if (array->array.tile(tile).is_powered()) {
        array->array.tile(tile).chip().reset(static_cast<tilenca::avr::ResetCause>(cause));
    }
}

void tilenca_tile_set_power(tilenca_array* array, unsigned tile, int on) {
    array->array.set_power(tile, on != 0);
}

int tilenca_tile_is_powered(tilenca_array* array, unsigned tile) {
    return array->array.tile(tile).is_powered();
}

void tilenca_tile_set_drift(tilenca_array* array, unsigned tile, double ppm_per_s) {
    array->array.tile(tile).clock().set_drift(ppm_per_s * 1e-6, array->array.now());
}

void tilenca_tile_set_fuses(tilenca_array* array, unsigned tile, unsigned low, unsigned high,
                            unsigned extended, unsigned lock) {
    auto& chip = array->array.tile(tile).chip();
    chip.fuses() = {static_cast<uint8_t>(low), static_cast<uint8_t>(high), static_cast<uint8_t>(extended),
                    static_cast<uint8_t>(lock)};
    chip.reset(tilenca::avr::ResetCause::PowerOn);
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
    auto& chip = array->array.tile(tile).chip();
    chip.adc().set_input(channel, static_cast<uint16_t>(value));
    chip.comparator().inputs_changed(chip.cpu().cycle);
}

void tilenca_tile_set_adc_noise(tilenca_array* array, unsigned tile, double deviation, uint64_t seed) {
    array->array.tile(tile).chip().adc().set_noise(deviation, seed);
}

void tilenca_tile_set_comparator(tilenca_array* array, unsigned tile, unsigned ain0, unsigned ain1) {
    auto& chip = array->array.tile(tile).chip();
    chip.comparator().set_inputs(static_cast<uint16_t>(ain0), static_cast<uint16_t>(ain1), chip.cpu().cycle);
}

void tilenca_tile_set_spi_loopback(tilenca_array* array, unsigned tile, int on) {
    array->array.tile(tile).chip().spi().set_loopback(on != 0);
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
        return fail("EEPROM address beyond 4095");
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

int tilenca_tile_write_memory(tilenca_array* array, unsigned tile, unsigned address, const uint8_t* bytes,
                              unsigned count) {
    auto& cpu = array->array.tile(tile).chip().cpu();
    if (address > tilenca::avr::kDataBytes || count > tilenca::avr::kDataBytes - address) {
        return fail("data address beyond 0x21FF");
    }
    std::copy(bytes, bytes + count, cpu.data + address);
    return 0;
}

void tilenca_tile_cycles(tilenca_array* array, unsigned tile, uint64_t cycles[3]) {
    const auto& cpu = array->array.tile(tile).chip().cpu();
    cycles[0] = cpu.cycle;
    cycles[1] = cpu.sleep_cycles;
    cycles[2] = array->array.tile(tile).cycles_off();
}
