// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace shadow_layers {

/// 128-bit content hash (XXH3). Equal keys mean equal bytes.
struct ContentKey {
    std::uint64_t low = 0, high = 0;
    auto operator<=>(const ContentKey&) const = default;
};

/// An axis-aligned box; made empty.
struct Bounds {
    glm::dvec3 min{std::numeric_limits<double>::infinity()}, max{-std::numeric_limits<double>::infinity()};
    bool is_empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
    void add(const glm::dvec3& point) { min = glm::min(min, point), max = glm::max(max, point); }
    void add(const Bounds& other) { min = glm::min(min, other.min), max = glm::max(max, other.max); }
};

/// A unique triangle mesh in object space. Immutable once made, shared by instances and by frames.
/// `owner` keeps the memory behind the spans alive (a vector, a NumPy array, a mapped file).
struct Mesh {
    std::string name;
    std::span<const glm::vec3> positions;   ///< object space, scene units
    std::span<const glm::uvec3> triangles;  ///< indices into positions; either winding
    std::shared_ptr<const void> owner;
    ContentKey positions_key, topology_key;  ///< separate: a deforming mesh keeps its topology key
    Bounds bounds;                           ///< of the usable vertices that triangles use (scene/bounds.h)
};

/// Copies nothing, computes the two keys and the bounds, and checks every index (InputError names mesh, triangle and
/// index).
/// Not-finite vertices are allowed here: triangles that use one are dropped by the core, counted and reported.
std::shared_ptr<const Mesh> make_mesh(std::string name, std::span<const glm::vec3> positions,
                                      std::span<const glm::uvec3> triangles, std::shared_ptr<const void> owner);

/// Per-instance visibility, as Cycles' ray visibility has it.
enum InstanceFlag : std::uint32_t {
    kInstanceCamera = 1u << 0,   ///< seen by the camera: a receiver
    kInstanceShadow = 1u << 1,   ///< casts shadows
    kInstanceHoldout = 1u << 2,  ///< seen by the camera as a hole: coverage 0, visibility 1
};

/// One placement of a mesh. Groups index the 64-bit sets of the lights (light and shadow linking).
struct Instance {
    std::uint32_t mesh = 0;  ///< index into Scene::meshes
    std::uint32_t flags = kInstanceCamera | kInstanceShadow;
    glm::dmat4 world_from_object{1.0};
    std::uint8_t receiver_group = 0;  ///< 0..63, tested against Light::receiver_set
    std::uint8_t blocker_group = 0;   ///< 0..63, tested against Light::blocker_set
};

enum class LightKind : std::uint8_t { Sun, Spot, Point, Area };

inline constexpr std::uint64_t kAllGroups = ~std::uint64_t{0};

/// A light. Its local -Z axis is the direction of sun, spot and area lights; the axes of `world_from_light`
/// are orthonormal (scale is in `area_size` and `spot_scale`).
struct Light {
    std::string name;
    LightKind kind = LightKind::Point;
    glm::dmat4 world_from_light{1.0};
    glm::vec3 color{1.0f};                    ///< linear RGB, without `energy`
    double energy = 1.0;                      ///< W for point, spot and area; W/m2 for the sun (Blender's units)
    double radius = 0.0;                      ///< point and spot: sphere radius, scene units
    double sun_angle = 0.0;                   ///< sun: angular diameter, radians
    double spot_angle = 0.785398;             ///< spot: full cone angle, radians, in (0, pi]
    glm::dvec2 spot_scale{1.0};               ///< spot: the cone's width along the light's x and y, of the round one's
    double spot_blend = 0.15;                 ///< spot: 0..1, softness of the cone's rim (shading only)
    glm::dvec2 area_size{1.0};                ///< area: world size along the light's x and y
    bool area_round = false;                  ///< area: ellipse instead of rectangle
    bool casts_shadow = true;                 ///< false: visibility is 1 on every face turned to the light
    std::uint64_t receiver_set = kAllGroups;  ///< bit g: receivers of group g are lit by this light
    std::uint64_t blocker_set = kAllGroups;   ///< bit g: casters of group g cast for this light
};

/// The scene at one moment. Plain data; safe to share between threads once filled.
struct Scene {
    std::vector<std::shared_ptr<const Mesh>> meshes;
    std::vector<Instance> instances;
    std::vector<Light> lights;
};

/// Throws InputError for what can't be rendered at all (mesh index out of range, a matrix that is not finite, a spot
/// angle outside (0, pi], group > 63). Names the instance or the light by index and name.
void validate(const Scene& scene);

}  // namespace shadow_layers
