// The pins' part of the C interface: levels, what drives them from outside, and the probes that look at them.
#include "api/private.h"

using namespace tilenca::c_api;

int tilenca_tile_pin(tilenca_array* array, unsigned tile, char port, unsigned bit) {
    return guarded(-1, [&] {
        auto& chip = tile_of(array, tile).chip();
        return int{chip.gpio().level(pin_of(port, bit), chip.cpu().cycle)};
    });
}

double tilenca_tile_duty(tilenca_array* array, unsigned tile, char port, unsigned bit) {
    return guarded(-1.0, [&] { return tile_of(array, tile).chip().duty(pin_of(port, bit)); });
}

int tilenca_tile_hold_pin(tilenca_array* array, unsigned tile, char port, unsigned bit, int level) {
    return attempted([&] {
        auto& chip = tile_of(array, tile).chip();
        const std::optional<bool> wanted = level < 0 ? std::nullopt : std::optional<bool>(level != 0);
        chip.gpio().hold_input(pin_of(port, bit), wanted, chip.cpu().cycle);
    });
}

int tilenca_tile_push_edge(tilenca_array* array, unsigned tile, char port, unsigned bit, uint64_t cycle,
                           int level) {
    return attempted([&] {
        auto& chip = tile_of(array, tile).chip();
        const tilenca::avr::PinId pin = pin_of(port, bit);
        check_range("a cycle", cycle, uint64_t{0}, tilenca::avr::kLastCycle);
        if (!chip.gpio().has_line(pin)) {
            chip.gpio().attach_line(pin, tilenca::avr::Drive::High);
        }
        const tilenca::avr::Line& line = *chip.gpio().line(pin);
        if (line.edges() == 0 &&
            !is_driven(line.drive_at(chip.cpu().cycle))) { // from now on somebody drives it
            chip.push_edge(pin, chip.cpu().cycle, tilenca::avr::Drive::High);
        }
        chip.push_edge(pin, cycle, tilenca::avr::drive_of(level != 0));
    });
}

int tilenca_tile_set_analog(tilenca_array* array, unsigned tile, unsigned channel, unsigned value) {
    return attempted([&] {
        auto& chip = tile_of(array, tile).chip();
        check_index("analog channel", channel, 16);
        check_range("an analog value", value, 0u, 1023u);
        chip.adc().set_input(channel, static_cast<uint16_t>(value));
        chip.comparator().inputs_changed(chip.cpu().cycle);
    });
}

int tilenca_tile_set_supply(tilenca_array* array, unsigned tile, double volts) {
    return attempted([&] {
        check_range("a supply in volts", volts, 1.8, 5.5);
        auto& chip = tile_of(array, tile).chip();
        chip.adc().set_supply(volts);
        chip.comparator().inputs_changed(chip.cpu().cycle);
    });
}

int tilenca_tile_set_adc_noise(tilenca_array* array, unsigned tile, double deviation, uint64_t seed) {
    return attempted([&] {
        check_range("the noise's deviation", deviation, 0.0, 1024.0);
        tile_of(array, tile).chip().adc().set_noise(deviation, seed);
    });
}

int tilenca_tile_set_comparator(tilenca_array* array, unsigned tile, unsigned ain0, unsigned ain1) {
    return attempted([&] {
        auto& chip = tile_of(array, tile).chip();
        check_range("AIN0", ain0, 0u, 1024u);
        check_range("AIN1", ain1, 0u, 1024u);
        chip.comparator().set_inputs(static_cast<uint16_t>(ain0), static_cast<uint16_t>(ain1),
                                     chip.cpu().cycle);
    });
}

int tilenca_tile_set_spi_loopback(tilenca_array* array, unsigned tile, int on) {
    return attempted([&] { tile_of(array, tile).chip().spi().set_loopback(on != 0); });
}

int tilenca_side_pin(unsigned side, int receives, char* port, unsigned* bit) {
    return attempted([&] {
        check_index("side", side, tilenca::kSides);
        const tilenca::avr::PinId pin =
            receives != 0 ? tilenca::Tile::receive_pin(side) : tilenca::Tile::transmit_pin(side);
        present(port, "the place for the port") = "ABCDEFGHJKL"[pin.port];
        present(bit, "the place for the bit") = pin.bit;
    });
}

// --- probes ---

namespace {

// Null: freed.
tilenca::Probe*& probe_of(tilenca_array* array, unsigned probe) {
    array_of(array);
    check_index("probe", probe, static_cast<long long>(array->eyes.size()));
    return array->eyes[probe].probe;
}

} // namespace

int tilenca_probe_new(tilenca_array* array, unsigned tile, char port, unsigned bit, double baud) {
    return guarded(-1, [&] {
        check_range("a probe's rate in baud", baud, -1e9, 1e9);
        tilenca::Tile& looked_at = tile_of(array, tile);
        const tilenca::avr::PinId pin = pin_of(port, bit);
        array->eyes.push_back({tile, nullptr}); // first, since it may fail
        tilenca::Probe& probe = looked_at.add_probe(pin);
        if (baud >= 0) {
            probe.read_bytes(baud);
        }
        array->eyes.back().probe = &probe;
        return static_cast<int>(array->eyes.size()) - 1;
    });
}

int tilenca_probe_free(tilenca_array* array, unsigned probe) {
    return attempted([&] {
        if (tilenca::Probe*& there = probe_of(array, probe); there != nullptr) {
            tile_of(array, array->eyes[probe].tile).remove_probe(*there);
            there = nullptr;
        }
    });
}

int tilenca_probe_level(tilenca_array* array, unsigned probe) {
    return guarded(-1, [&] {
        const tilenca::Probe* there = probe_of(array, probe);
        return int{there != nullptr && there->level()};
    });
}

ptrdiff_t tilenca_probe_edges(tilenca_array* array, unsigned probe, double* times, uint8_t* levels,
                              size_t room) {
    return guarded<ptrdiff_t>(-1, [&] {
        tilenca::Probe* there = probe_of(array, probe);
        size_t taken = 0;
        for (; there != nullptr && taken < room && !there->edges().empty(); taken++) {
            const tilenca::Probe::Edge edge = there->edges().front();
            (&present(times, "the room for times"))[taken] = edge.ticks / tilenca::kTicksPerSecond;
            (&present(levels, "the room for levels"))[taken] = edge.level;
            there->note_taken(edge);
            there->edges().pop_front();
        }
        return static_cast<ptrdiff_t>(taken);
    });
}

ptrdiff_t tilenca_probe_bytes(tilenca_array* array, unsigned probe, double* times, uint8_t* values,
                              uint8_t* framing_errors, size_t room) {
    return guarded<ptrdiff_t>(-1, [&] {
        tilenca::Probe* there = probe_of(array, probe);
        size_t taken = 0;
        for (; there != nullptr && taken < room && !there->receiver().received().empty(); taken++) {
            const auto byte = there->receiver().received().front();
            (&present(times, "the room for times"))[taken] = byte.ticks / tilenca::kTicksPerSecond;
            (&present(values, "the room for values"))[taken] = byte.value;
            (&present(framing_errors, "the room for framing errors"))[taken] = byte.framing_error;
            there->receiver().received().pop_front();
        }
        return static_cast<ptrdiff_t>(taken);
    });
}
