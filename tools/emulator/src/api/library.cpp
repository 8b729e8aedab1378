// The library's own part of the C interface, and the checks that all parts use.
#include "api/private.h"

namespace tilenca::c_api {

Array& array_of(tilenca_array* handle) {
    return present(handle, "the array").array;
}

Tile& tile_of(tilenca_array* handle, unsigned tile) {
    Array& array = array_of(handle);
    check_index("tile", tile, array.size());
    return array.tile(tile);
}

Array::End end_of(tilenca_array* handle, unsigned tile, unsigned side) {
    check_index("tile", tile, array_of(handle).size());
    check_index("side", side, kSides);
    return {tile, side};
}

avr::PinId pin_of(char port, unsigned bit) {
    if (port < 'A' || port > 'L' || port == 'I' || bit > (port == 'G' ? 5 : 7)) {
        throw Refusal("no pin P" + std::string(1, port) + std::to_string(bit) +
                      "; ports are A to L without I, bits 0 to 7, of G 0 to 5");
    }
    return {avr::port_index(port), static_cast<uint8_t>(bit)};
}

Clock clock_of(double ppm, double switch_on_s) {
    check_range("a clock error in ppm", ppm, -kMostError * 1e6, kMostError * 1e6);
    check_range("a time of switching on", switch_on_s, 0.0, 1e9);
    return Clock(ppm * 1e-6, 0, switch_on_s * kTicksPerSecond);
}

} // namespace tilenca::c_api

int tilenca_emulator_abi_version(void) {
    return TILENCA_EMULATOR_ABI_VERSION;
}

size_t tilenca_emulator_size_of(const char* structure) {
    using tilenca::c_api::Size;
    const Size all[] = {TILENCA_SIZE(tilenca_wire_fault), TILENCA_SIZE(tilenca_wire_counts),
                        TILENCA_SIZE(tilenca_cycles), TILENCA_SIZE(tilenca_stack),
                        TILENCA_SIZE(tilenca_hardware)};
    return tilenca::c_api::size_among(all, structure);
}

const char* tilenca_emulator_last_error(void) {
    return tilenca::c_api::last_error();
}
