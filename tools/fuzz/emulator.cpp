// The targets of the emulator that read files: snapshots, images.
#include "base_array.h"
#include "targets.h"

#include <array>
#include <cstring>
#include <string>

namespace tilenca {
namespace fuzz {

namespace {

constexpr double kAfterwardsS = 0.4e-3; // an array that was loaded runs on so long
constexpr size_t kDullBytes = 1000;     // as many alike in a row are empty memory, and no fields

// A real snapshot, and where in it something stands that is no empty memory.
struct Base {
    std::unique_ptr<Array> array;
    std::vector<uint8_t> bytes;
    std::vector<uint32_t> places;

    explicit Base(unsigned variant) : array(base_array(variant)), bytes(array->save()) {
        bytes.resize(bytes.size() - sizeof(uint32_t)); // the checksum is made anew
        for (size_t begin = 0, end = 0; begin < bytes.size(); begin = end) {
            for (end = begin; end < bytes.size() && bytes[end] == bytes[begin]; ++end) {
            }
            for (size_t i = begin; end - begin < kDullBytes && i < end; ++i) {
                places.push_back(static_cast<uint32_t>(i));
            }
        }
    }
};

Base& base_of(unsigned variant) {
    static std::array<std::unique_ptr<Base>, kVariants> all;
    if (all[variant] == nullptr) {
        all[variant] = std::make_unique<Base>(variant);
    }
    return *all[variant];
}

uint32_t checksum(const std::vector<uint8_t>& bytes) { // FNV-1a
    uint32_t hash = 2166136261u;
    for (const uint8_t byte : bytes) {
        hash = (hash ^ byte) * 16777619u;
    }
    return hash;
}

// Applies changes: two bytes say the place, one the kind and how many follow, and these are what stands
// there.
void change(std::vector<uint8_t>& snapshot, const std::vector<uint32_t>& places, const uint8_t* bytes,
            size_t size) {
    while (size > 3) {
        const size_t place = places[(bytes[0] | bytes[1] << 8) % places.size()];
        const size_t count = std::min<size_t>(1 + bytes[2] % 8, size - 3);
        bytes += 3;
        for (size_t i = 0; i < count && place + i < snapshot.size(); ++i) {
            snapshot[place + i] = bytes[i];
        }
        bytes += count;
        size -= 3 + count;
    }
}

bool loads(Array& array, const std::vector<uint8_t>& snapshot) {
    try {
        array.load(snapshot.data(), snapshot.size());
        return true;
    } catch (const avr::ArchiveError& error) {
        must(error.what()[0] != '\0' && strchr(error.what(), '\n') == nullptr, "a reason that is no line");
        return false;
    }
}

} // namespace

void snapshots(const uint8_t* bytes, size_t size) {
    if (size == 0) {
        return;
    }
    Base& base = base_of(bytes[0] % kVariants);
    std::vector<uint8_t> snapshot = base.bytes;
    change(snapshot, base.places, bytes + 1, size - 1);
    const uint32_t hash = checksum(snapshot);
    for (unsigned i = 0; i < sizeof hash; ++i) {
        snapshot.push_back(static_cast<uint8_t>(hash >> (8 * i)));
    }
    Array& array = *base.array;
    if (loads(array, snapshot)) {
        const std::vector<uint8_t> again = array.save();
        must(loads(array, again), "a snapshot of what was loaded does not load");
        must(array.save() == again, "a snapshot that was loaded is saved as another");
        array.run_for(kAfterwardsS * kTicksPerSecond);
        for (unsigned tile = 0; tile < array.size(); ++tile) {
            uint8_t duty[3];
            array.tile(tile).colour(duty);
            array.tile(tile).leds();
            array.tile(tile).segments();
            array.fault(tile);
        }
        array.save();
    }
    // Whatever was loaded, a good snapshot brings a good array back.
    std::vector<uint8_t> good = base.bytes;
    const uint32_t right = checksum(good);
    for (unsigned i = 0; i < sizeof right; ++i) {
        good.push_back(static_cast<uint8_t>(right >> (8 * i)));
    }
    must(loads(array, good) && array.save() == good, "a good snapshot does not bring the array back");
}

void images(const uint8_t* bytes, size_t size) {
    Image image;
    try {
        if (size != 0 && bytes[0] == ':') {
            image = load_hex("file", std::string(bytes, bytes + size));
        } else {
            image = load_elf("file", std::vector<uint8_t>(bytes, bytes + size));
        }
    } catch (const ImageError& error) {
        must(strncmp(error.what(), "file:", 5) == 0 && strchr(error.what(), '\n') == nullptr,
             "a reason that is no line, or names no file");
        return;
    }
    must(!image.flash.empty(), "an image without a program");
    for (const Symbol& symbol : image.symbols) {
        image.find(symbol.name);
        image.function_at(symbol.address);
    }
    Array array(image, avr::Fuses(), {Clock()}); // as far as a chip takes them
    array.run_for(0.1e-3 * kTicksPerSecond);
    array.fault(0);
}

const std::vector<Named>& targets() {
    static const std::vector<Named> all = {{"snapshots", snapshots}, {"images", images}, {"calls", calls}};
    return all;
}

} // namespace fuzz
} // namespace tilenca
