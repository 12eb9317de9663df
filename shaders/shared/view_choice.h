// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// Which view of a light sample serves a receiver: the data and the one rule, compiled by C++ and by GLSL. A further
// kind (cascades of a sun) is a constant here, the data that it goes by, a branch of choose_view, and a maker of its
// views in native/lights/light_views.cpp.

#ifdef __cplusplus
#include <glm/glm.hpp>
namespace shadow_layers {
using glm::ivec4;
#define VIEW_FUNCTION     \
    template <class Vec3> \
    inline int
#else
#define VIEW_FUNCTION int
#define Vec3 vec3
#endif

const int kMaxViews = 6;   // of a light sample; a map array has a layer per view
const int kNoView = -1;    // no caster can lie before the receiver
const int kOneView = 0;    // kinds: all receivers are served by view 0,
const int kCubeFaces = 1;  // or each by the view of the cube face that it lies behind

// A part of a uniform block in std140 layout.
struct ViewChoice {
    ivec4 kind;             // x: kOneView or kCubeFaces; y: number of views; z, w unused
    ivec4 view_of_face[2];  // kCubeFaces: by face, 0..3 and 4, 5; or kNoView
};

// +X -X +Y -Y +Z -Z of the axes that `direction` is given in.
VIEW_FUNCTION find_cube_face(Vec3 direction) {
    Vec3 size = abs(direction);
    if (size.x >= size.y && size.x >= size.z) return direction.x >= 0 ? 0 : 1;
    if (size.y >= size.z) return direction.y >= 0 ? 2 : 3;
    return direction.z >= 0 ? 4 : 5;
}

// The view of a receiver, or kNoView. `direction`: from the light to the receiver, in the light sample's axes.
VIEW_FUNCTION choose_view(ViewChoice choice, Vec3 direction) {
    if (choice.kind.x == kOneView) return choice.kind.y > 0 ? 0 : kNoView;
    int face = find_cube_face(direction);
    return choice.view_of_face[face / 4][face % 4];
}

#undef VIEW_FUNCTION
#ifdef __cplusplus
}  // namespace shadow_layers
#else
#undef Vec3
#endif
