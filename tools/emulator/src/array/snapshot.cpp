// Saving and loading a whole array.
#include "array/array.h"

#include <cmath>
#include <cstring>
#include <map>

namespace tilenca {

namespace {

constexpr uint32_t kMagic = 0x53434C54; // "TLCS"
constexpr uint32_t kVersion = 6;        // one more whenever any state() changes

// FNV-1a.
uint32_t hash_of(const uint8_t* bytes, size_t count, uint32_t hash = 2166136261u) {
    for (size_t i = 0; i < count; i++) {
        hash = (hash ^ bytes[i]) * 16777619u;
    }
    return hash;
}

using Ends = std::vector<std::pair<Array::End, Array::End>>;

// A cable joins two tiles, in both directions; a side has one at most.
void check_cables(const Ends& ends) {
    const auto key = [](const Array::End& end) { return end.tile * kSides + end.side; };
    std::map<unsigned, unsigned> leads;
    for (const auto& [from, to] : ends) {
        if (from.tile == to.tile || !leads.emplace(key(from), key(to)).second) {
            throw avr::ArchiveError("a side has two cables, or one that leads back");
        }
    }
    for (const auto& [from, to] : leads) {
        if (const auto back = leads.find(to); back == leads.end() || back->second != from) {
            throw avr::ArchiveError("a cable has one direction only");
        }
    }
}

} // namespace

// A snapshot means nothing to another image.
uint32_t Array::image_number() const {
    uint32_t hash = 2166136261u;
    for (const Block& block : image_.flash) {
        hash = hash_of(block.bytes.data(), block.bytes.size(), hash);
    }
    return hash;
}

std::vector<uint8_t> Array::save() {
    catch_up(); // a tile that was added since has not run yet
    avr::Archive archive;
    uint32_t magic = kMagic, version = kVersion, image = image_number(), tiles = size(),
             wires = static_cast<uint32_t>(wires_.size());
    archive(magic, version, image, tiles, wires);
    for (const auto& wire : wires_) {
        End from = wire->from(), to = wire->to();
        archive(from.tile, from.side, to.tile, to.side);
    }
    archive(now_, asked_for_, common_.delay, common_.unpowered, hardware_);
    for (const auto& one : tiles_) {
        archive(*one);
    }
    for (const auto& wire : wires_) {
        archive(*wire);
    }
    uint32_t hash = hash_of(archive.saved().data(), archive.saved().size());
    archive(hash);
    return archive.saved();
}

void Array::load(const uint8_t* bytes, size_t count) {
    uint32_t hash = 0;
    if (count < sizeof hash) {
        throw avr::ArchiveError("it ends early");
    }
    count -= sizeof hash;
    std::memcpy(&hash, bytes + count, sizeof hash);
    if (hash != hash_of(bytes, count)) {
        throw avr::ArchiveError("it is damaged, or no snapshot at all");
    }
    avr::Archive archive(bytes, count);
    uint32_t magic = 0, version = 0, image = 0, tiles = 0, wires = 0;
    archive(magic, version);
    if (magic != kMagic || version != kVersion) {
        throw avr::ArchiveError("no snapshot that this version of the emulator has made");
    }
    archive(image, tiles, wires);
    if (image != image_number()) {
        throw avr::ArchiveError("a snapshot of tiles that run another image");
    }
    if (tiles == 0 || tiles > kMostTiles || tiles > count / avr::kDataBytes || wires > kSides * tiles) {
        throw avr::ArchiveError("it has more tiles or cables than can be, or none");
    }
    std::vector<std::pair<End, End>> ends;
    for (uint32_t i = 0; i < wires; i++) {
        End from{}, to{};
        archive(from.tile, from.side, to.tile, to.side);
        if (from.tile >= tiles || to.tile >= tiles || from.side >= kSides || to.side >= kSides) {
            throw avr::ArchiveError("a cable leads nowhere");
        }
        ends.emplace_back(from, to);
    }
    check_cables(ends);
    wires_.clear();
    while (size() > tiles) {
        tiles_.pop_back();
    }
    while (size() < tiles) {
        add_tile(Clock());
    }
    for (const auto& [from, to] : ends) {
        connect(from, to);
    }
    rebuild_order();
    auto delay = common_.delay;
    archive(now_, asked_for_, delay, common_.unpowered, hardware_);
    if (!(delay >= kLeastDelayTicks && delay <= kMostDelayTicks)) {
        throw avr::ArchiveError("its cables take longer than any can");
    }
    if (!(now_ >= 0 && asked_for_ <= now_ && now_ - asked_for_ < kQuantumTicks &&
          std::fmod(now_, kQuantumTicks) == 0)) {
        throw avr::ArchiveError("its time is none that an array comes to");
    }
    common_.delay = delay;
    turn_ = turn_of(common_.delay);
    for (const auto& one : tiles_) {
        archive(*one);
        const avr::Cpu& cpu = one->chip().cpu();
        if (cpu.fault.empty() && !one->clock().has_come_to(now_, cpu.cycle)) {
            throw avr::ArchiveError("a tile is at another time than the others");
        }
    }
    for (const auto& wire : wires_) {
        archive(*wire);
    }
    if (!archive.at_end()) {
        throw avr::ArchiveError("it does not end where it should");
    }
}

} // namespace tilenca
