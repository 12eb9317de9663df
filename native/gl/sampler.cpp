// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "gl/sampler.h"

namespace shadow_layers::gl {
namespace {

GLuint create_sampler(const Device& device) {
    GLuint id = 0;
    device.gl().CreateSamplers(1, &id);
    return id;
}

}  // namespace

ValueSampler::ValueSampler(const Device& device, GLuint unit, std::string_view label)
    : Tracked(device, create_sampler(device), GL_SAMPLER, label), unit_(unit) {
    gl().SamplerParameteri(id(), GL_TEXTURE_COMPARE_MODE, GL_NONE);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        gl().SamplerParameteri(id(), filter, GL_NEAREST);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
        gl().SamplerParameteri(id(), wrap, GL_CLAMP_TO_EDGE);
    gl().BindSampler(unit_, id());
}

ValueSampler::~ValueSampler() {
    gl().BindSampler(unit_, 0);
    const GLuint name = take();
    gl().DeleteSamplers(1, &name);
}

}  // namespace shadow_layers::gl
