// Saves the state of a chip into bytes, or loads it from there: each class lists its state once, for both
// ways.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace tilenca::avr {

// The bytes end early, or hold something that cannot be.
struct ArchiveError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

class Archive {
  public:
    // Saves.
    Archive() = default;
    // Loads; the bytes must live on.
    Archive(const uint8_t* bytes, size_t count) : from_(bytes), count_(count), loading_(true) {}

    bool loading() const { return loading_; }
    bool at_end() const { return position_ == count_; }
    const std::vector<uint8_t>& saved() const { return saved_; }

    void bytes(void* data, size_t count) {
        if (!loading_) {
            const auto* source = static_cast<const uint8_t*>(data);
            saved_.insert(saved_.end(), source, source + count);
            return;
        }
        if (count > count_ - position_) {
            throw ArchiveError("it ends early");
        }
        std::memcpy(data, from_ + position_, count);
        position_ += count;
    }

    // What was loaded must be so: a snapshot can be made by hand, and a chip relies on what it knows of
    // itself.
    void require(bool holds, const char* fact) const {
        if (loading_ && !holds) {
            throw ArchiveError(fact);
        }
    }
    // The same for a number that lies between two others, which belong to the range.
    template <class T>
    void require_range(T value, T least, T greatest, const char* fact) const {
        require(value >= least && value <= greatest, fact);
    }

    // Numbers and flags only: a struct's padding would make equal states differ. An enumeration says its last
    // value by last_of(), so that no other is loaded.
    template <class T>
    std::enable_if_t<std::is_arithmetic_v<T> || std::is_enum_v<T>> one(T& value) {
        if constexpr (std::is_same_v<T, bool>) {
            uint8_t byte = value;
            bytes(&byte, 1);
            value = byte != 0;
        } else {
            bytes(&value, sizeof value);
            if constexpr (std::is_enum_v<T>) {
                require(value <= last_of(value), "it has a value that there is not");
            } else if constexpr (std::is_floating_point_v<T>) {
                require(std::abs(value) <= kGreatest, "it has a number that no measure takes"); // nor NaN
            }
        }
    }
    template <class T, size_t n>
    void one(std::array<T, n>& values) {
        for (T& value : values) {
            one(value);
        }
    }
    template <class T>
    auto one(T& value) -> decltype(value.state(*this)) {
        return value.state(*this);
    }
    template <class T>
    void one(std::vector<T>& values) {
        uint32_t count = static_cast<uint32_t>(values.size());
        one(count);
        if (loading_) {
            if (count > count_ - position_) { // each element takes a byte at least
                throw ArchiveError("a list is longer than all of it");
            }
            values.assign(count, T{});
        }
        for (T& value : values) {
            one(value);
        }
    }
    void one(std::string& text) {
        std::vector<char> characters(text.begin(), text.end());
        one(characters);
        text.assign(characters.begin(), characters.end());
    }

    template <class... T>
    void operator()(T&... values) {
        (one(values), ...);
    }

    // Of all measures: time goes on by less than a quantum there, still.
    static constexpr double kGreatest = 1e18;

  private:
    std::vector<uint8_t> saved_;
    const uint8_t* from_ = nullptr;
    size_t count_ = 0, position_ = 0;
    bool loading_ = false;
};

} // namespace tilenca::avr
