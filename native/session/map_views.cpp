// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "session/map_views.h"

namespace shadow_layers {

std::vector<MapView> describe_views(const LightSample& sample) {
    std::vector<MapView> views;
    for (const LightView& view : sample.views) {
        MapView& described = views.emplace_back();
        described.perspective = view.perspective;
        described.face = sample.choice.kind.x == kCubeFaces ? int(view.face) : -1;
        for (int i = 0; i < 2; ++i) {
            const double half = 1 / view.lc_from_ls[i][i];
            described.corner[i] = half * (view.perspective ? view.lc_from_ls[2][i] : -view.lc_from_ls[3][i]) - half;
            described.texel_size[i] = 2 * half / view.size_texels;
        }
        described.view_from_world = view.ls_from_ws;
    }
    return views;
}

}  // namespace shadow_layers
