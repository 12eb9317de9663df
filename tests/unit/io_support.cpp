// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "unit/io_support.h"

#include <zip.h>

namespace shadow_layers::test {

std::string make_npy(const std::string& descr, const std::string& shape, const std::string& data,
                     const std::string& fortran_order) {
    std::string header = "{'descr': '" + descr + "', 'fortran_order': " + fortran_order + ", 'shape': " + shape + ", }";
    while ((10 + header.size() + 1) % 64 != 0) header += ' ';
    header += '\n';
    std::string text = "\x93NUMPY";
    text += '\x01';
    text += '\0';
    text += char(header.size() & 0xff);
    text += char(header.size() >> 8);
    return text + header + data;
}

nlohmann::json make_snapshot_json() {
    const nlohmann::json identity = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    return {{"format", "shadow-layers-snapshot"},
            {"version", 1},
            {"source", {{"blender", "4.5.15"}, {"file", "a.blend"}, {"frame", 7}}},
            {"meshes", {{{"name", "Ground"}}, {{"name", "Leaf"}}}},
            {"instances", {{{"name", "Ground"}}, {{"name", "Leaf.001"}}, {{"name", "Leaf.002"}}}},
            {"lights",
             {{{"name", "Key"},
               {"kind", "SPOT"},
               {"world_from_light", {{1, 0, 0, 5}, {0, 1, 0, 6}, {0, 0, 1, 7}, {0, 0, 0, 1}}},
               {"color", {1, 0.5, 0.25}},
               {"energy", 100.5},
               {"radius", 0.25},
               {"sun_angle", 0.01},
               {"spot_angle", 0.75},
               {"spot_blend", 0.5},
               {"area_size", {2, 3}},
               {"area_round", true},
               {"casts_shadow", false},
               {"receiver_set", "fffffffffffffffe"},
               {"blocker_set", "8000000000000001"}}}},
            {"camera",
             {{"perspective", true},
              {"window", {-1, 1, -0.5, 0.5}},
              {"clip_start", 0.1},
              {"clip_end", 100},
              {"world_from_camera", identity}}},
            {"render",
             {{"width", 640},
              {"height", 320},
              {"region", {10, 20, 300, 200}},
              {"samples", 4},
              {"filter", "GAUSSIAN"},
              {"filter_width", 2.5}}},
            {"jobs",
             {{{"light", 0},
               {"technique", "sm"},
               {"parameters", {{"map_size", 512}, {"a", 0.5}, {"b", true}, {"c", "x"}}}}}},
            {"warnings", {"hair was left out"}}};
}

std::map<std::string, std::string> make_snapshot_members() {
    std::vector<double> matrices;
    for (int i = 0; i < 3; ++i) {
        for (const double value : {1.0, 0.0, 0.0, 0.5 * i, 0.0, 1.0, 0.0, 2.0, 0.0, 0.0, 1.0, 3.0, 0.0, 0.0, 0.0, 1.0})
            matrices.push_back(value);
    }
    return {
        {"snapshot.json", make_snapshot_json().dump()},
        {"mesh_positions_0.npy", make_npy("<f4", "(4, 3)", bytes_of<float>({-1, 0, -1, 1, 0, -1, 1, 0, 1, -1, 0, 1}))},
        {"mesh_triangles_0.npy", make_npy("<u4", "(2, 3)", bytes_of<std::uint32_t>({0, 1, 2, 0, 2, 3}))},
        {"mesh_positions_1.npy", make_npy("<f4", "(3, 3)", bytes_of<float>({0, 1, 0, 1, 1, 0, 0, 1, 1}))},
        {"mesh_triangles_1.npy", make_npy("<u4", "(1, 3)", bytes_of<std::uint32_t>({0, 1, 2}))},
        {"instance_mesh.npy", make_npy("<u4", "(3,)", bytes_of<std::uint32_t>({0, 1, 1}))},
        {"instance_matrix.npy", make_npy("<f8", "(3, 4, 4)", bytes_of(matrices))},
        {"instance_flags.npy", make_npy("<u4", "(3,)", bytes_of<std::uint32_t>({3, 2, 5}))},
        {"instance_receiver_group.npy", make_npy("|u1", "(3,)", bytes_of<std::uint8_t>({0, 1, 63}))},
        {"instance_blocker_group.npy", make_npy("|u1", "(3,)", bytes_of<std::uint8_t>({2, 3, 4}))},
    };
}

void write_zip(const std::filesystem::path& path, const std::map<std::string, std::string>& members, bool deflate) {
    int code = 0;
    zip_t* archive = zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, &code);
    ASSERT_NE(archive, nullptr);
    for (const auto& [name, bytes] : members) {
        zip_source_t* source = zip_source_buffer(archive, bytes.data(), bytes.size(), 0);
        const zip_int64_t index = zip_file_add(archive, name.c_str(), source, ZIP_FL_OVERWRITE);
        ASSERT_GE(index, 0);
        zip_set_file_compression(archive, zip_uint64_t(index), deflate ? ZIP_CM_DEFLATE : ZIP_CM_STORE, 1);
    }
    ASSERT_EQ(zip_close(archive), 0);
}

}  // namespace shadow_layers::test
