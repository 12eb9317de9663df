// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "shadow_layers/camera.h"
#include "shadow_layers/parameters.h"
#include "shadow_layers/scene.h"

namespace shadow_layers {

/// A float picture: `data[(y * width + x) * channels + c]`, row 0 at the bottom.
struct Image {
    int width = 0, height = 0, channels = 1;
    std::vector<float> data;
};

/// Reconstruction filter of the pixel, with its full width in pixels (Cycles: film filter).
enum class PixelFilterKind : std::uint8_t { Box, Gaussian, BlackmanHarris };

struct PixelFilter {
    PixelFilterKind kind = PixelFilterKind::BlackmanHarris;
    double width_px = 1.5;
};

/// One light worked by one technique. A layer comes back for each.
struct LayerJob {
    std::uint32_t light = 0;  ///< index into Scene::lights
    std::string technique;
    ParameterValues parameters;  ///< unresolved: only what differs from the defaults
};

struct RenderRequest {
    std::shared_ptr<const Scene> scene;
    Camera camera;
    int width = 0, height = 0;  ///< full picture, pixels
    PixelRect region;           ///< part to render; empty = whole
    int samples = 1;            ///< 1..64 per pixel; 1 = the pixel's centre, whatever the filter
    PixelFilter filter;
    std::vector<LayerJob> jobs;
    bool combined = true;          ///< make the clay picture
    std::vector<std::string> aux;  ///< any of "position", "normal", "ids", "depth": of the first sample
};

/// Time of a stage, summed over samples. `gl_ms` < 0 where no GL ran.
struct StageTime {
    std::string stage;
    double cpu_ms = 0, gl_ms = -1;
};

/// Times and counts that come with each result. Counters: "triangles", "silhouette_edges", "edge_fragments",
/// "map_bytes", ...: each named in the technique's docs page; of the frame "mesh_data_bytes", held after it.
struct RenderStats {
    std::vector<StageTime> times;
    std::map<std::string, std::int64_t> counters;
    double total_ms = 0;  ///< wall time of this layer, or of the frame
};

/// A shadow map's view, as far as it tells where a point lies in the map. A point (x, y, z) of its light space, which
/// looks along -Z, lies at (x, y) / -z of the map's plane, or (x, y) if it isn't perspective.
struct MapView {
    bool perspective = true;
    int face = -1;                    ///< cube face 0..5 (+X -X +Y -Y +Z -Z of the light's axes); -1: the only view
    glm::dvec2 corner{0.0};           ///< of the map's first texel (its border included), in that plane
    glm::dvec2 texel_size{0.0};       ///< in that plane
    glm::dmat4 view_from_world{1.0};  ///< rigid: world to the view's light space
};

struct Layer {
    std::uint32_t job = 0;                  ///< index into RenderRequest::jobs
    ParameterValues parameters;             ///< resolved: every parameter with its value
    std::map<std::string, Image> channels;  ///< by OutputSpec::id; "visibility" always; size of the region
    std::vector<MapView> views;             ///< of the first sample, from the light's first position; empty: no maps
    RenderStats stats;
};

/// What each pixel sees, by number: an index into Scene::instances and one into that mesh's triangles; -1, -1: nothing.
/// Whole numbers, because floats round those above 2^24. Two a pixel, rows as in Image.
struct IdImage {
    int width = 0, height = 0;
    std::vector<std::int64_t> data;
};

struct FrameResult {
    Image coverage;                    ///< 1 channel, 0..1
    Image combined;                    ///< RGBA, linear, alpha = coverage, premultiplied; empty unless asked for
    std::map<std::string, Image> aux;  ///< "position": xyz in world axes relative to camera_position; "normal": unit,
                                       ///< towards the camera; "depth": along -Z. Of those asked for
    IdImage ids;                       ///< empty unless "ids" were asked for
    glm::dvec3 camera_position{0.0};
    std::vector<std::string> warnings;  ///< what was dropped or approximated, each named once
    RenderStats stats;
};

/// Called on the caller's thread, in job order, as soon as the layer is whole; the layer is moved out.
using LayerSink = std::function<void(Layer&&)>;

/// Fraction done, 0..1, with a short text. Called on the caller's thread.
using ProgressSink = std::function<void(double, const std::string&)>;

}  // namespace shadow_layers
