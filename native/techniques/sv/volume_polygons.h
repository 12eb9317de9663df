// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "frame/frame.h"
#include "lights/light_views.h"
#include "scene/silhouettes.h"
#include "techniques/sv/picture_raster.h"

namespace shadow_layers {

class ThreadPool;

/// A polygon of the shadow volumes' surface, wound so that it is seen from outside with its corners to the left.
struct VolumePolygon {
    enum class Kind : std::uint8_t { Side, Cap, FarCap };

    std::array<PictureLine, 4> lines;
    std::uint8_t line_count = 0;
    Kind kind = Kind::Side;
    std::int32_t layers = 1;  ///< volumes that it closes: a silhouette's multiplicity
    PixelBox box;             ///< empty rows: nothing to draw
    glm::dvec3 outward{0.0};  ///< of its plane, not of unit length; (0, 0, 0) of far caps
    double offset = 0;        ///< points outside: dot(outward, point_rel) + offset > 0
    double tolerance = 0;     ///< rounding of that sum, without the part that comes with the point
    PixelIds ids;             ///< caps: the caster
    std::array<std::uint32_t, 3> weld{kNoVertex, kNoVertex, kNoVertex};  ///< caps: its corners
};

/// The shadow volumes of one instance. Every triangle that has an area casts one, away from the light and without end;
/// sides where volumes touch cancel, so that what is left are those at the silhouette edges.
class CasterVolumes {
public:
    CasterVolumes(const Frame& frame, const LightSample& sample, const PictureSpace& picture, std::uint32_t instance,
                  const MeshEdges& edges, ThreadPool& threads);

    /// Polygons by number: sides, then caps, then far caps (none of a sun: its volumes have no width at infinity).
    std::size_t size() const { return side_count() + cap_count() + far_cap_count(); }
    std::size_t side_count() const { return silhouettes_.size(); }
    std::size_t cap_count() const { return sides_of_triangles_.size(); }
    std::size_t far_cap_count() const { return directional_ ? 0 : cap_count(); }
    /// False if no pixel can see it.
    bool make(std::size_t number, VolumePolygon& polygon) const;

private:
    enum Side : std::uint8_t { kFacing, kAway, kNone };
    struct Vertex {
        glm::dvec3 rel, near, far;  ///< its place; in the picture; where it is extruded to in the picture
    };
    void place_vertices(ThreadPool& threads);
    void find_sides(ThreadPool& threads);
    bool make_side(const SilhouetteEdge& edge, VolumePolygon& polygon) const;
    bool make_cap(std::uint32_t triangle, bool far, VolumePolygon& polygon) const;
    PictureLine line_of_edge(std::uint32_t from, std::uint32_t to, bool far) const;
    PictureLine line_of_extrusion(std::uint32_t vertex, bool towards_light) const;
    void set_plane(const glm::dvec3& normal, const glm::dvec3& point, VolumePolygon& polygon) const;

    const Mesh& mesh_;
    const MeshAdjacency& adjacency_;
    const PictureSpace& picture_;
    std::uint32_t instance_;
    bool directional_;
    glm::dvec3 light_rel_;  ///< or the direction to a sun
    glm::dmat3 linear_;
    glm::dvec3 offset_rel_;
    glm::dvec4 light_in_object_;
    std::vector<SilhouetteEdge> silhouettes_;
    std::vector<Vertex> vertices_;
    std::vector<std::uint8_t> sides_of_triangles_;
};

}  // namespace shadow_layers
