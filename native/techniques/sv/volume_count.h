// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "engine/engine.h"
#include "frame/frame.h"
#include "lights/light_views.h"
#include "techniques/sv/picture_raster.h"
#include "techniques/sv/volume_polygons.h"

namespace shadow_layers {

/// Counts, per receiver, the shadow volumes that it lies in: along the camera's ray from the receiver to infinity, +1
/// where it leaves a volume and -1 where it enters one. What lies before the receiver has no say, so the camera may be
/// inside of volumes and of solids.
class VolumeCounter {
public:
    VolumeCounter(Engine& engine, const Frame& frame, const Light& light, const LightSample& sample);

    /// 1 = the light reaches the receiver, by pixel; by lights/facing.h where no caster decides.
    /// Counts "receivers", "list_bytes", "silhouette_edges", "volume_quads" and "cap_triangles" (of those that the
    /// picture may show).
    std::vector<float> compute_visibility();

private:
    struct RowRange {
        int begin = 0, end = 0;
    };
    bool find_receivers();
    void count_bytes();
    void draw_instance(std::uint32_t instance);
    void flush();
    void draw_band(int row_begin, int row_end);
    void draw(const VolumePolygon& polygon, int row);
    void add_side(const VolumePolygon& polygon, int row, PixelSpan span, int sign);
    void add_cap(const VolumePolygon& polygon, int row, PixelSpan span, int sign);
    bool is_own_plane(const VolumePolygon& polygon, std::size_t pixel) const;

    Engine& engine_;
    const Frame& frame_;
    const Light& light_;
    const LightSample& sample_;
    PictureSpace picture_;
    std::map<std::uint32_t, MeshEdges> edges_;  ///< by mesh
    std::vector<float> visibility_;
    std::vector<std::uint8_t> decided_;  ///< 1: no caster has a say
    std::vector<std::int32_t> counts_;
    std::vector<double> x_, y_, z_;        ///< receivers that the casters decide, relative to the frame's origin
    std::vector<PixelSpan> asked_;         ///< by row: where they are
    double greatest_rel_ = 0;              ///< greatest sum of a receiver's coordinates' magnitudes
    std::vector<VolumePolygon> polygons_;  ///< of the chunk
    std::vector<RowRange> ranges_;         ///< their rows
    std::size_t used_ = 0;
};

}  // namespace shadow_layers
