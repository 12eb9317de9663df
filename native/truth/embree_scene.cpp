// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "truth/embree_scene.h"

#include <set>

#include "truth/light_rule.h"

namespace shadow_layers::truth {
namespace {

void attach(RTCScene scene, RTCGeometry geometry) {
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
}

}  // namespace

void EmbreeScene::append(const Mesh& mesh, const glm::dmat4& matrix, Triangles& to) {
    const auto first = std::uint32_t(to.positions.size());
    for (const glm::vec3& p : mesh.positions) to.positions.emplace_back(matrix * glm::dvec4(p, 1));
    for (const glm::uvec3& t : mesh.triangles) to.indices.push_back(t + first);
}

EmbreeScene::EmbreeScene(RTCDevice device, const Scene& scene, const Light& light, const glm::dvec3& origin_ws,
                         RTCBuildQuality quality, bool instanced)
    : device_(device), quality_(quality) {
    parts_.resize(instanced ? scene.meshes.size() : 1);
    std::set<std::uint32_t> filled;
    for (const Instance& instance : scene.instances) {
        if (!may_cast(light, instance)) continue;
        glm::dmat4 matrix = instance.world_from_object;
        matrix[3] -= glm::dvec4(origin_ws, 0);
        const Mesh& mesh = *scene.meshes[instance.mesh];
        if (!instanced) {
            append(mesh, matrix, parts_.front());
            continue;
        }
        if (filled.insert(instance.mesh).second) append(mesh, glm::dmat4(1.0), parts_[instance.mesh]);
        places_.push_back({instance.mesh, glm::mat4(matrix)});
    }
    for (Triangles& part : parts_) part.positions.emplace_back(0.0f);  // Embree reads 16 bytes of a vertex
}

EmbreeScene::~EmbreeScene() {
    for (RTCScene scene : scenes_)
        if (scene) rtcReleaseScene(scene);
}

void EmbreeScene::build() {
    for (const Triangles& part : parts_) {
        scenes_.push_back(part.indices.empty() ? nullptr : make_scene());
        if (scenes_.back()) {
            attach_triangles(scenes_.back(), part);
            rtcCommitScene(scenes_.back());
        }
    }
    if (places_.empty() && !scenes_.empty() && scenes_.front()) return;
    const RTCScene top = make_scene();
    for (const auto& [part, matrix] : places_) attach_instance(top, scenes_[part], matrix);
    rtcCommitScene(top);
    scenes_.push_back(top);
}

RTCScene EmbreeScene::make_scene() const {
    const RTCScene scene = rtcNewScene(device_);
    rtcSetSceneBuildQuality(scene, quality_);
    return scene;
}

void EmbreeScene::attach_triangles(RTCScene scene, const Triangles& triangles) const {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(geometry, quality_);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, triangles.positions.data(), 0,
                               sizeof(glm::vec3), triangles.positions.size() - 1);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, triangles.indices.data(), 0,
                               sizeof(glm::uvec3), triangles.indices.size());
    attach(scene, geometry);
}

void EmbreeScene::attach_instance(RTCScene scene, RTCScene part, const glm::mat4& matrix) const {
    if (!part) return;
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, part);
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, &matrix);
    attach(scene, geometry);
}

}  // namespace shadow_layers::truth
