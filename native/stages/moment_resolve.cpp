// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "stages/moment_resolve.h"

namespace shadow_layers {

const gl::Texture& MomentResolvePass::run(Engine& engine, const Frame& frame, const Light& light,
                                          const LightSample& position, const MomentMapOptions& options,
                                          const gl::Program& program, const std::function<void()>& set_uniforms) {
    const auto depths = render_depth_map(engine, *frame.scene, position);
    const auto map = render_moment_map(engine, position, *depths, options);
    const auto bind = [&] {
        map->bind(program);
        set_uniforms();
    };
    return resolve_.run(engine, {.frame = frame,
                                 .light = light,
                                 .position = position,
                                 .program = program,
                                 .work_per_pixel = 4,
                                 .bind_inputs = bind});
}

}  // namespace shadow_layers
