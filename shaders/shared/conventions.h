// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// The one list of conventions, compiled by C++ and by GLSL.
//
//   handedness     right-handed everywhere; cameras and light views look along their -Z, +Y up
//   spaces         _ws world, _rel world axes about the camera, _vs camera view, _ls light view, _lc light clip,
//                  _uv map texture; matrices are named target_from_source
//   depth in maps  "depth_rz": reversed, 1 on the near plane, 0 on the far plane, planar over a triangle
//   clip control   GL_LOWER_LEFT, GL_ZERO_TO_ONE, for the whole life of the context
//   pictures       row 0 is the bottom row; pixel and texel centres at +0.5
//   visibility     1 = lit, 0 = in shadow; background 1
//   winding        either: faces have two sides, nothing is culled by winding

#ifdef __cplusplus
namespace shadow_layers {
#endif

const float kDepthNear = 1.0f;  // depth_rz on the near plane
const float kDepthFar = 0.0f;   // depth_rz on the far plane, and the clear value
const float kLit = 1.0f;
const float kShadowed = 0.0f;

#ifdef __cplusplus
}  // namespace shadow_layers
#endif
