// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Sessions of the GL tests: OSMesa, two threads, an error of GL ends the render.
#pragma once

#include "shadow_layers/session.h"

namespace shadow_layers::testing {

inline SessionOptions make_session_options() {
    SessionOptions options;
    options.backend = "osmesa";
    options.threads = 2;
    options.shader_dir = SHADOW_LAYERS_SHADER_DIR;
    options.debug = true;
    return options;
}

/// One session for all tests of the program: making one takes longer than most tests.
inline Session& shared_session() {
    static Session session(make_session_options());
    return session;
}

}  // namespace shadow_layers::testing
