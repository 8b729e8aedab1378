#include <doctest/doctest.h>

#include <type_traits>

#include "../support.h"
#include "core/cell.h"
#include "core/crc16.h"
#include "core/network.h"
#include "model/model.h"

using namespace tilenca;
using test::Numbers;
using test::RandomModel;

namespace {

struct NetworkCase {
    const char* name;
    uint8_t channels, hidden1, hidden2;
    uint32_t seed;
    int32_t reach;
    int updates;
    const char* first_state;
    uint16_t crc_of_all_states;
};

const NetworkCase kCases[] = {
#define CASE(name, c, h1, h2, seed, reach, updates, first, crc)                                              \
    {name, c, h1, h2, seed, reach, updates, first, crc},
#include "networks.inc"
#undef CASE
};

std::string text_of(const int16_t* state, uint8_t channels) {
    std::vector<std::string> values;
    for (uint8_t c = 0; c < channels; ++c) {
        values.push_back(std::to_string(state[c]));
    }
    return test::joined(values, " ");
}

// CRC of any number of bytes: crc16() starts over at each call, so this one goes on by hand.
uint16_t crc_of_states(const std::vector<int16_t>& states) {
    uint16_t crc = 0xFFFF;
    for (int16_t state : states) {
        for (uint8_t byte : {static_cast<uint8_t>(state), static_cast<uint8_t>(state >> 8)}) {
            for (int bit = 7; bit >= 0; --bit) {
                const bool feedback = (crc >> 15 ^ byte >> bit) & 1;
                crc = static_cast<uint16_t>(crc << 1 ^ (feedback ? 0x1021 : 0));
            }
        }
    }
    return crc;
}

void update(Cell& cell, const int8_t* const (&neighbours)[kSides]) {
    cell.perceive(neighbours);
    int slices = 0;
    while (!cell.update_slice()) {
        REQUIRE(++slices < 100);
    }
}

// One layer of one output, for sums that are easy to see.
int8_t hidden_output_of(int8_t weight, int16_t bias, int8_t input) {
    const LayerStream stream(1, 1, &weight, &bias);
    int8_t outputs[kBlockOutputs];
    const int16_t sum = hidden_outputs(stream.layer(), {&input, input}, 0, 1, outputs);
    CHECK(sum == outputs[0]); // those that the layer does not have are zero
    return outputs[0];
}

int16_t state_after(int16_t state, int8_t weight, int16_t bias, int8_t input) {
    const LayerStream stream(1, 1, &weight, &bias);
    int16_t states[] = {state, 99};
    add_outputs(stream.layer(), {&input, input}, 0, 1, states);
    CHECK(states[1] == 99); // of another output, which the layer does not have
    return states[0];
}

} // namespace

// A forgotten flash read must not compile: a view turns into nothing an ordinary read could use.
static_assert(!std::is_convertible<FlashView<int8_t>, const int8_t*>::value, "no pointer");
static_assert(!std::is_convertible<FlashView<int8_t>, int8_t>::value, "no value");
static_assert(!std::is_constructible<const int8_t*, FlashView<int8_t>>::value, "not even by a cast");

TEST_CASE("every state of a long run is that of the numpy reference") {
    for (const NetworkCase& golden : kCases) {
        CAPTURE(golden.name);
        Numbers numbers(golden.seed);
        const RandomModel random(golden.channels, golden.hidden1, golden.hidden2, 0, numbers, golden.reach);
        const Model model = random.model();
        Cell cell(model.network);
        std::vector<int16_t> all_states;
        for (int i = 0; i < golden.updates; ++i) {
            const auto messages = numbers.draw_all<int8_t>(kSides * golden.channels, -127, 127);
            const int8_t* first = messages.data();
            update(cell, {first, first + golden.channels, first + 2 * golden.channels,
                          first + 3 * golden.channels});
            all_states.insert(all_states.end(), cell.state(), cell.state() + golden.channels);
            if (i == 0) {
                CHECK(text_of(cell.state(), golden.channels) == golden.first_state);
            }
        }
        CHECK(crc_of_states(all_states) == golden.crc_of_all_states);
    }
}

TEST_CASE("a hidden output is rounded half up and kept in 0..127") {
    CHECK(hidden_output_of(0, 31, 0) == 0);
    CHECK(hidden_output_of(0, 32, 0) == 1);
    CHECK(hidden_output_of(0, 95, 0) == 1);
    CHECK(hidden_output_of(0, 96, 0) == 2);
    CHECK(hidden_output_of(0, -32, 0) == 0);
    CHECK(hidden_output_of(0, 127 * 64 + 31, 0) == 127);
    CHECK(hidden_output_of(127, 32767, 127) == 127);
    CHECK(hidden_output_of(-127, -32768, 127) == 0);
}

TEST_CASE("a state saturates symmetrically") {
    CHECK(state_after(16256, 0, 1, 0) == 16256);
    CHECK(state_after(-16256, 0, -1, 0) == -16256);
    CHECK(state_after(16256, 127, 32767, 127) == 16256);
    CHECK(state_after(-16256, -127, -32768, 127) == -16256);
    CHECK(state_after(100, -3, 7, 5) == 92);
}

TEST_CASE("a message is rounded half up, with an exact zero, and never -128") {
    CHECK(message_of(0) == 0);
    CHECK(message_of(63) == 0);
    CHECK(message_of(64) == 1);
    CHECK(message_of(-64) == 0);
    CHECK(message_of(-65) == -1);
    CHECK(message_of(8192) == 64);
    CHECK(message_of(16256) == 127);
    CHECK(message_of(-16256) == -127);
}

TEST_CASE("a cell starts as the seed and can be made one again in the middle of an update") {
    Numbers numbers(9);
    const RandomModel random(21, 40, 40, 10, numbers, 40);
    const Model model = random.model();
    Cell cell(model.network);
    const auto is_seed = [&] {
        CHECK(text_of(cell.state(), 21) == "8192 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0");
        CHECK(cell.message()[0] == 64);
        CHECK(cell.message()[1] == 0);
        CHECK_FALSE(cell.updating());
    };
    is_seed();
    update(cell, {nullptr, nullptr, nullptr, nullptr});
    CHECK(text_of(cell.state(), 21) != "8192 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0 0");
    cell.perceive({nullptr, nullptr, nullptr, nullptr});
    CHECK_FALSE(cell.update_slice());
    cell.seed();
    is_seed();
    CHECK_FALSE(cell.update_slice());
}

TEST_CASE("an absent neighbour reads as zeros, also after one was there") {
    Numbers numbers(10);
    const RandomModel random(5, 9, 9, 2, numbers, 40);
    const Model model = random.model();
    const int8_t zeros[5] = {};
    const int8_t loud[5] = {127, -127, 127, -127, 127};
    Cell with_nobody(model.network), with_zeros(model.network);
    update(with_nobody, {loud, loud, loud, loud});
    update(with_zeros, {loud, loud, loud, loud});
    update(with_nobody, {nullptr, nullptr, nullptr, nullptr});
    update(with_zeros, {zeros, zeros, zeros, zeros});
    CHECK(text_of(with_nobody.state(), 5) == text_of(with_zeros.state(), 5));
}

TEST_CASE("the message stays that of the last whole update while the next is under way") {
    Numbers numbers(11);
    const RandomModel random(21, 40, 40, 10, numbers, 60);
    const Model model = random.model();
    Cell cell(model.network);
    cell.perceive({nullptr, nullptr, nullptr, nullptr});
    int slices = 0;
    do {
        CHECK(cell.message()[0] == 64);
        REQUIRE(++slices < 100);
    } while (!cell.update_slice());
    CHECK(slices > 3);
    CHECK(cell.message()[0] == message_of(cell.state()[0]));
}

TEST_CASE("the best class has the greatest stored score, the first among equals") {
    const std::vector<int8_t> zeros(20, 0);
    const auto best_of = [&](std::vector<int16_t> scores) {
        const uint8_t channels = static_cast<uint8_t>(scores.size() + 1);
        std::vector<int16_t> biases(1, 0);
        biases.insert(biases.end(), scores.begin(), scores.end());
        const int16_t no_bias = 0;
        const LayerStream hidden1(5 * channels, 1, zeros.data(), &no_bias);
        const LayerStream hidden2(1, 1, zeros.data(), &no_bias);
        const LayerStream output(1, channels, zeros.data(), biases.data());
        const Network network = {hidden1.layer(), hidden2.layer(), output.layer()};
        Cell cell(network);
        update(cell, {nullptr, nullptr, nullptr, nullptr});
        return cell.decide(static_cast<uint8_t>(scores.size())).best;
    };
    CHECK(best_of({0, 0, 0}) == 0);
    CHECK(best_of({5, 4, 3}) == 0);
    CHECK(best_of({-3, -1, -1}) == 1);
    CHECK(best_of({100, 101, 99}) == 1); // all three are the same message
    CHECK(best_of({-9, -8, -7}) == 2);
}

TEST_CASE("a decision says how far the best class is ahead of the second best, rounded to a message") {
    const auto margin_of = [](std::vector<int16_t> scores) {
        return decide(scores.data(), static_cast<uint8_t>(scores.size())).margin;
    };
    CHECK(margin_of({7, 7}) == 0);
    CHECK(margin_of({63, 0}) == 0);
    CHECK(margin_of({64, 0}) == 1);
    CHECK(margin_of({0, 191}) == 1);
    CHECK(margin_of({0, 192}) == 2);
    CHECK(margin_of({1280, 9000, 2560, -16000}) == 50);
    CHECK(margin_of({-16000, 2560, 9000, 1280}) == 50);
    CHECK(margin_of({9000, 2560, 1280}) == 50);
    CHECK(margin_of({kStateMax, -kStateMax}) == 254);
    CHECK(margin_of({-kStateMax, -kStateMax, kStateMax}) == 254);
    CHECK(margin_of({5}) == Decision::kNoMargin);
}

TEST_CASE("a tile is missing on the side with the greatest score above one half, the first among equals") {
    const auto side_of = [](const std::vector<int8_t>& scores) { return missing_side(scores.data()); };
    CHECK(side_of({0, 0, 0, 0}) == kSides);
    CHECK(side_of({32, 32, -127, 32}) == kSides);
    CHECK(side_of({33, 32, 0, 0}) == index_of(Side::North));
    CHECK(side_of({40, 70, 70, 60}) == index_of(Side::East));
    CHECK(side_of({-127, -127, -127, 127}) == index_of(Side::West));
}

TEST_CASE("the exported model is whole") {
    CHECK(model::kModel.id == model::kModelId);
    CHECK(model::kModel.network.channels() == model::kChannels);
    CHECK(model::kModel.network.hidden1.inputs == kNeighbourhood * model::kChannels);
    CHECK(model::kModel.network.hidden2.inputs == model::kHidden1);
    CHECK(model::kModel.network.output.inputs == model::kHidden2);
    CHECK(model::kModel.classes == model::kClasses);
    for (uint8_t k = 0; k < model::kClasses; ++k) {
        CHECK(model::kModel.looks[k].segments != 0);
        CHECK(model::kModel.looks[k].label > ' ');
    }
}
