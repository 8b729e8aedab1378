// The firmware's core behind a C interface, for models of any size: host/tilenca/native.py calls it.
#include <stddef.h>
#include <stdint.h>

#include "core/network.h"

extern "C" {

// Weights row-major [output][input]; all pointers stay the caller's.
struct TilencaModel {
    uint8_t channels;
    uint8_t hidden1;
    uint8_t hidden2;
    const int8_t* w1;
    const int16_t* b1;
    const int8_t* w2;
    const int16_t* b2;
    const int8_t* w3;
    const int16_t* b3;
};

// Updates `count` cells in place: states[count][C], inputs[count][5 C] (own message, then N, E, S, W).
__attribute__((visibility("default"))) void tilenca_update_cells(const TilencaModel* model, int16_t* states,
                                                                 const int8_t* inputs, size_t count) {
    using tilenca::FlashView;
    const uint8_t wide = tilenca::kTaps * model->channels;
    const tilenca::Network network = {
        {wide, model->hidden1, FlashView<int8_t>(model->w1), FlashView<int16_t>(model->b1)},
        {model->hidden1, model->hidden2, FlashView<int8_t>(model->w2), FlashView<int16_t>(model->b2)},
        {model->hidden2, model->channels, FlashView<int8_t>(model->w3), FlashView<int16_t>(model->b3)},
    };
    tilenca::Forward forward(network);
    for (size_t i = 0; i < count; ++i) {
        forward.begin(inputs + i * wide, states + i * model->channels);
        while (!forward.done()) {
            forward.step();
        }
    }
}

} // extern "C"
