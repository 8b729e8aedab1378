// Whole tiles that are wired to each other in one process.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "../support.h"
#include "app/tile.h"

namespace tilenca {
namespace test {

constexpr uint8_t kNobody = 0xFF;

// What the line between two tiles may do to a frame: change it in place, repeat it, or swallow it.
using Fault = std::function<std::vector<std::vector<uint8_t>>(std::vector<uint8_t>)>;

// Tiles wired to each other in one process; the test owns the clock. Frames arrive within the same
// millisecond.
class Array {
  public:
    Array(const Model& model, Settings settings, std::vector<std::array<uint8_t, kSides>> neighbours)
        : neighbours_(std::move(neighbours)) {
        for (size_t i = 0; i < neighbours_.size(); ++i) {
            tiles_.push_back(std::make_unique<Tile>(model, settings, 0));
        }
    }

    Tile& operator[](size_t index) { return *tiles_[index]; }

    void run_until(uint32_t end_ms) {
        for (; now_ms < end_ms; ++now_ms) {
            for (size_t i = 0; i < tiles_.size(); ++i) {
                if (present(i)) {
                    tiles_[i]->tick(now_ms);
                    pass_frames(i);
                }
            }
        }
    }

    void take_away(size_t index) { absent_ = index; }
    void put_back() { absent_ = kNobody; }

    Fault fault = [](std::vector<uint8_t> frame) { return std::vector<std::vector<uint8_t>>{frame}; };
    uint32_t now_ms = 0;

  private:
    bool present(size_t index) const { return index != absent_; }

    void pass_frames(size_t from) {
        for (uint8_t i = 0; i < kSides; ++i) {
            const Side side = side_at(i);
            if (!tiles_[from]->has_frame(side)) {
                continue;
            }
            uint8_t wire[kMaxFrame];
            const uint8_t size = tiles_[from]->take_frame(side, wire);
            const uint8_t to = neighbours_[from][i];
            if (to == kNobody || !present(to)) {
                continue;
            }
            for (const auto& frame : fault({wire, wire + size})) {
                for (uint8_t byte : frame) {
                    tiles_[to]->receive(opposite(side), byte, now_ms);
                }
            }
        }
    }

    std::vector<std::array<uint8_t, kSides>> neighbours_;
    std::vector<std::unique_ptr<Tile>> tiles_;
    size_t absent_ = kNobody;
};

// Four tiles in a square: 0 1 / 2 3.
inline const std::vector<std::array<uint8_t, kSides>> kSquare = {
    {kNobody, 1, 2, kNobody}, {kNobody, kNobody, 3, 0}, {0, 3, kNobody, kNobody}, {1, kNobody, kNobody, 2}};
inline const std::vector<std::array<uint8_t, kSides>> kAlone = {{kNobody, kNobody, kNobody, kNobody}};

// A model, and what tiles in step do with it.
struct ArrayFixture {
    Numbers numbers{42};
    RandomModel random{6, 12, 10, 3, numbers, 30};
    Model model = random.model();

    // The messages of every tile after n updates in step, computed with cells alone.
    std::vector<std::vector<int8_t>> square_after(int updates) const {
        std::vector<Cell> cells(4, Cell(model.network));
        for (int n = 0; n < updates; ++n) {
            std::vector<std::vector<int8_t>> told;
            for (const Cell& cell : cells) {
                told.emplace_back(cell.message(), cell.message() + 6);
            }
            for (size_t i = 0; i < cells.size(); ++i) {
                const int8_t* heard[kSides];
                for (uint8_t side = 0; side < kSides; ++side) {
                    heard[side] = kSquare[i][side] == kNobody ? nullptr : told[kSquare[i][side]].data();
                }
                cells[i].perceive(heard);
                while (!cells[i].update_slice()) {
                }
            }
        }
        std::vector<std::vector<int8_t>> messages;
        for (const Cell& cell : cells) {
            messages.emplace_back(cell.message(), cell.message() + 6);
        }
        return messages;
    }

    static std::vector<int8_t> message_of(const Tile& tile) { return {tile.message(), tile.message() + 6}; }

    static uint32_t received_by(Tile& tile) {
        uint32_t sum = 0;
        for (uint8_t i = 0; i < kSides; ++i) {
            sum += tile.link(side_at(i)).counters().received;
        }
        return sum;
    }
};

} // namespace test
} // namespace tilenca
