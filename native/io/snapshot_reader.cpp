// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
// Snapshots, as docs/snapshot.md lays them down. Nothing in the file is trusted: sizes are checked before memory is
// taken, and memory grows with what was really read, not with what a header claims.
#include <algorithm>
#include <charconv>
#include <cstring>

#include "io/json_fields.h"
#include "io/npy.h"
#include "io/scene_file.h"
#include "io/zip_archive.h"
#include "shadow_layers/error.h"
#include "shadow_layers/names.h"

namespace shadow_layers::io {
namespace {

constexpr int kVersion = 1;
constexpr std::size_t kMaxJsonBytes = std::size_t{256} << 20;
constexpr std::size_t kPieceBytes = std::size_t{16} << 20;

// The elements of a member, in memory of their own.
template <class T>
std::shared_ptr<std::vector<T>> read_array(const ZipArchive& archive, const std::string& name, const NpySpec& wanted) {
    ZipArchive::Stream stream = archive.open(name + ".npy");
    std::vector<std::byte> start(std::min<std::uint64_t>(stream.size(), kMaxNpyHeaderBytes));
    start.resize(stream.read(start));
    NpyHeader header;
    std::size_t bytes = 0;
    try {
        header = parse_npy_header(start);
        bytes = check_npy_header(header, wanted);
    } catch (const FileError& error) {
        stream.fail(error.what());
    }
    if (bytes % sizeof(T) != 0) stream.fail("internal: element size");
    auto values = std::make_shared<std::vector<T>>();
    std::size_t done = std::min(bytes, start.size() - header.data_offset);
    values->resize((done + sizeof(T) - 1) / sizeof(T));
    if (done > 0) std::memcpy(values->data(), start.data() + header.data_offset, done);
    std::size_t surplus = start.size() - header.data_offset - done;
    while (done < bytes) {
        const std::size_t piece = std::min(bytes - done, kPieceBytes);
        values->resize((done + piece + sizeof(T) - 1) / sizeof(T));
        const std::size_t got = stream.read({reinterpret_cast<std::byte*>(values->data()) + done, piece});
        if (got < piece) {
            stream.fail("it is cut off: " + std::to_string(done + got) + " of " + std::to_string(bytes) +
                        " bytes; write the snapshot again");
        }
        done += got;
    }
    // Reading to the end also makes libzip compare the checksum.
    std::byte beyond;
    surplus += stream.read({&beyond, 1});
    if (surplus > 0) stream.fail("it goes on after its last element; write the snapshot again");
    return values;
}

LightKind light_kind(const JsonField& field) {
    const std::string kind = field.string();
    if (const auto found = find_light_kind(kind)) return *found;
    field.fail("'" + kind + "' is no kind of light; it is " + kLightKindNames);
}

std::uint64_t bit_set(const JsonField& field) {
    const std::string text = field.string();
    std::uint64_t bits = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), bits, 16);
    if (error != std::errc() || end != text.data() + text.size())
        field.fail("'" + text + "' is not up to 16 hexadecimal digits");
    return bits;
}

Light read_light(const JsonField& field) {
    Light light;
    light.name = field["name"].string();
    light.kind = light_kind(field["kind"]);
    light.world_from_light = field["world_from_light"].matrix();
    const auto color = field["color"].numbers(3);
    light.color = glm::vec3(float(color[0]), float(color[1]), float(color[2]));
    light.energy = field["energy"].number();
    light.radius = field["radius"].number();
    light.sun_angle = field["sun_angle"].number();
    light.spot_angle = field["spot_angle"].number();
    light.spot_blend = field["spot_blend"].number();
    if (field.object().contains("spot_scale")) {  // older files have none
        const auto scale = field["spot_scale"].numbers(2);
        light.spot_scale = {scale[0], scale[1]};
    }
    const auto size = field["area_size"].numbers(2);
    light.area_size = {size[0], size[1]};
    light.area_round = field["area_round"].boolean();
    light.casts_shadow = field["casts_shadow"].boolean();
    light.receiver_set = bit_set(field["receiver_set"]);
    light.blocker_set = bit_set(field["blocker_set"]);
    return light;
}

Camera read_camera(const JsonField& field) {
    Camera camera;
    camera.perspective = field["perspective"].boolean();
    const auto window = field["window"].numbers(4);
    camera.window = {window[0], window[1], window[2], window[3]};
    camera.clip_start = field["clip_start"].number();
    camera.clip_end = field["clip_end"].number();
    camera.world_from_camera = field["world_from_camera"].matrix();
    return camera;
}

PixelFilterKind filter_kind(const JsonField& field) {
    const std::string name = field.string();
    if (const auto found = find_pixel_filter(name)) return *found;
    field.fail("'" + name + "' is no pixel filter; it is " + kPixelFilterNames);
}

void read_render(const JsonField& field, SceneFile& file) {
    file.width = field["width"].integer(1, 1 << 20);
    file.height = field["height"].integer(1, 1 << 20);
    const JsonField region = field["region"];
    if (region.size() != 4) region.fail("wanted [x, y, width, height]");
    file.region = {region[0].integer(0, 1 << 20), region[1].integer(0, 1 << 20), region[2].integer(0, 1 << 20),
                   region[3].integer(0, 1 << 20)};
    file.samples = field["samples"].integer(1, 64);
    file.filter = {filter_kind(field["filter"]), field["filter_width"].number()};
}

LayerJob read_job(const JsonField& field, std::size_t light_count) {
    LayerJob job;
    job.light = std::uint32_t(field["light"].integer(0, std::numeric_limits<int>::max()));
    if (job.light >= light_count) {
        field["light"].fail(std::to_string(job.light) + " is beyond the " + std::to_string(light_count) + " lights");
    }
    job.technique = field["technique"].string();
    for (const auto& [id, value] : field["parameters"].object().items()) {
        job.parameters.set(id, field["parameters"][id].parameter());
    }
    return job;
}

void read_meshes(const ZipArchive& archive, const JsonField& field, Scene& scene) {
    for (std::size_t k = 0; k < field.size(); ++k) {
        const std::string number = std::to_string(k);
        auto positions = read_array<float>(archive, "mesh_positions_" + number, {"<f4", {-1, 3}});
        auto triangles = read_array<std::uint32_t>(archive, "mesh_triangles_" + number, {"<u4", {-1, 3}});
        const std::span points(reinterpret_cast<const glm::vec3*>(positions->data()), positions->size() / 3);
        const std::span corners(reinterpret_cast<const glm::uvec3*>(triangles->data()), triangles->size() / 3);
        auto owner = std::make_shared<std::pair<decltype(positions), decltype(triangles)>>(positions, triangles);
        scene.meshes.push_back(make_mesh(field[k]["name"].string(), points, corners, std::move(owner)));
    }
}

void read_instances(const ZipArchive& archive, Scene& scene) {
    const auto mesh = read_array<std::uint32_t>(archive, "instance_mesh", {"<u4", {-1}});
    const long count = long(mesh->size());
    const auto matrix = read_array<double>(archive, "instance_matrix", {"<f8", {count, 4, 4}});
    const auto flags = read_array<std::uint32_t>(archive, "instance_flags", {"<u4", {count}});
    const auto receivers = read_array<std::uint8_t>(archive, "instance_receiver_group", {"|u1", {count}});
    const auto blockers = read_array<std::uint8_t>(archive, "instance_blocker_group", {"|u1", {count}});
    scene.instances.resize(mesh->size());
    for (std::size_t i = 0; i < mesh->size(); ++i) {
        Instance& instance = scene.instances[i];
        instance.mesh = (*mesh)[i];
        instance.flags = (*flags)[i];
        instance.receiver_group = (*receivers)[i];
        instance.blocker_group = (*blockers)[i];
        for (int row = 0; row < 4; ++row) {
            for (int column = 0; column < 4; ++column) {
                instance.world_from_object[column][row] = (*matrix)[i * 16 + std::size_t(row * 4 + column)];
            }
        }
    }
}

nlohmann::json parse_json(const ZipArchive& archive) {
    nlohmann::json json;
    try {
        json = nlohmann::json::parse(archive.read_text("snapshot.json", kMaxJsonBytes));
    } catch (const nlohmann::json::exception& error) {
        archive.fail(std::string("member snapshot.json: ") + error.what());
    }
    return json;
}

}  // namespace

SceneFile read_snapshot(const std::filesystem::path& path) {
    const ZipArchive archive(path);
    if (!archive.has("snapshot.json")) {
        archive.fail("member snapshot.json is missing: this .npz is no snapshot (docs/snapshot.md)");
    }
    const nlohmann::json json = parse_json(archive);
    const JsonField root(json, "'" + path.string() + "': snapshot.json: ");
    if (root["format"].string() != "shadow-layers-snapshot") {
        root["format"].fail("'" + root["format"].string() + "' is not 'shadow-layers-snapshot'");
    }
    if (const int version = root["version"].integer(0, 1 << 30); version != kVersion) {
        root["version"].fail(std::to_string(version) + " cannot be read by this program, which reads version " +
                             std::to_string(kVersion) + "; use the Shadow Layers that wrote it, or a newer one");
    }
    SceneFile file;
    const JsonField lights = root["lights"], jobs = root["jobs"], warnings = root["warnings"];
    for (std::size_t i = 0; i < lights.size(); ++i) file.scene->lights.push_back(read_light(lights[i]));
    file.camera = read_camera(root["camera"]);
    read_render(root["render"], file);
    for (std::size_t i = 0; i < jobs.size(); ++i) file.jobs.push_back(read_job(jobs[i], lights.size()));
    for (std::size_t i = 0; i < warnings.size(); ++i) file.warnings.push_back(warnings[i].string());
    file.source = root["source"].object();
    read_meshes(archive, root["meshes"], *file.scene);
    read_instances(archive, *file.scene);
    validate(*file.scene);
    validate(file.camera);
    return file;
}

}  // namespace shadow_layers::io
