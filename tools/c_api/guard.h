// What every entry point of the C interfaces does: exceptions end here, and become the library's last error.
#pragma once

#include <cstddef>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>

namespace tilenca::c_api {

// A caller asked for something that does not exist. The message is for the user.
struct Refusal : std::runtime_error {
    using std::runtime_error::runtime_error;
};

constexpr size_t kLastErrorBytes = 1024;

// The text that the library's ..._last_error gives out; one for each thread. A fixed array, since noting that
// memory has run out must not need memory. Hidden symbols give each library its own.
inline char* last_error() {
    thread_local char text[kLastErrorBytes] = "";
    return text;
}

inline void note_error(const char* text) noexcept {
    std::snprintf(last_error(), kLastErrorBytes, "%s", text);
}

// Runs the body of an entry point: its result, or `failed` if it threw.
template <class Result, class Body>
Result guarded(Result failed, Body body) noexcept {
    try {
        return body();
    } catch (const std::bad_alloc&) {
        note_error("out of memory");
    } catch (const std::exception& error) {
        note_error(error.what());
    } catch (...) {
        note_error("an unknown exception");
    }
    return failed;
}

// The same for entry points that return 0 where they succeed and -1 where they fail.
template <class Body>
int attempted(Body body) noexcept {
    return guarded(-1, [&] {
        body();
        return 0;
    });
}

template <class T>
T& present(T* pointer, const char* what) {
    if (pointer == nullptr) {
        throw Refusal(std::string(what) + " is null");
    }
    return *pointer;
}

// `what` counts from 0 and must be below `count`.
inline void check_index(const char* what, long long index, long long count) {
    if (index < 0 || index >= count) {
        throw Refusal(std::string(what) + " " + std::to_string(index) + " does not exist; there are " +
                      std::to_string(count));
    }
}

// A number must be between two others, which belong to the range. NaN is in no range.
template <class Number>
void check_range(const char* what, Number value, Number least, Number greatest) {
    if (!(value >= least && value <= greatest)) {
        throw Refusal(std::string(what) + " is " + std::to_string(value) + "; it must be " +
                      std::to_string(least) + " to " + std::to_string(greatest));
    }
}

// The name and the size of a public structure.
struct Size {
    const char* name;
    size_t bytes;
};
#define TILENCA_SIZE(structure) {#structure, sizeof(structure)}

// The size of the structure of that name; 0: there is none.
template <size_t n>
size_t size_among(const Size (&all)[n], const char* name) {
    for (const Size& one : all) {
        if (name != nullptr && std::strcmp(one.name, name) == 0) {
            return one.bytes;
        }
    }
    return 0;
}

} // namespace tilenca::c_api
