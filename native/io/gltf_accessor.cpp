// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/gltf_accessor.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>

#include "shadow_layers/error.h"

namespace shadow_layers::io {
namespace {

// Elements in memory: `count` of them, `stride` bytes apart.
struct View {
    const unsigned char* data = nullptr;  // null: all zero
    std::size_t count = 0, stride = 0;
};

std::size_t component_bytes(int type) {
    const int bytes = tinygltf::GetComponentSizeInBytes(std::uint32_t(type));
    return bytes > 0 ? std::size_t(bytes) : 0;
}

View make_view(const tinygltf::Model& model, int view_index, std::size_t offset, std::size_t count,
               std::size_t element_bytes, bool tight, const std::string& place) {
    if (view_index < 0 || std::size_t(view_index) >= model.bufferViews.size()) {
        throw FileError(place + "buffer view " + std::to_string(view_index) + " does not exist");
    }
    const tinygltf::BufferView& view = model.bufferViews[std::size_t(view_index)];
    if (view.buffer < 0 || std::size_t(view.buffer) >= model.buffers.size()) {
        throw FileError(place + "buffer " + std::to_string(view.buffer) + " does not exist");
    }
    const auto& bytes = model.buffers[std::size_t(view.buffer)].data;
    if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset) {
        throw FileError(place + "buffer view " + std::to_string(view_index) + " reaches beyond its buffer of " +
                        std::to_string(bytes.size()) + " bytes; is the .bin file whole?");
    }
    const std::size_t stride = tight || view.byteStride == 0 ? element_bytes : view.byteStride;
    if (stride < element_bytes) throw FileError(place + "byteStride " + std::to_string(stride) + " is too small");
    const bool fits = count == 0 || (offset <= view.byteLength && element_bytes <= view.byteLength - offset &&
                                     (count - 1) <= (view.byteLength - offset - element_bytes) / stride);
    if (!fits) {
        throw FileError(place + std::to_string(count) + " elements reach beyond buffer view " +
                        std::to_string(view_index) + " of " + std::to_string(view.byteLength) + " bytes");
    }
    return {bytes.data() + view.byteOffset + offset, count, stride};
}

template <class T>
double read_component(const unsigned char* at, bool normalized) {
    T value;
    std::memcpy(&value, at, sizeof(T));
    if (!normalized || !std::numeric_limits<T>::is_integer) return double(value);
    // glTF 2.0, 3.6.2.2: signed types have two codes for -1.
    return std::max(double(value) / double(std::numeric_limits<T>::max()), -1.0);
}

double component(const unsigned char* at, int type, bool normalized) {
    switch (type) {
        case TINYGLTF_COMPONENT_TYPE_BYTE:
            return read_component<std::int8_t>(at, normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
            return read_component<std::uint8_t>(at, normalized);
        case TINYGLTF_COMPONENT_TYPE_SHORT:
            return read_component<std::int16_t>(at, normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
            return read_component<std::uint16_t>(at, normalized);
        case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
            return read_component<std::uint32_t>(at, normalized);
        default:
            return read_component<float>(at, false);
    }
}

bool is_index_type(int type) {
    return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
           type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

const tinygltf::Accessor& find(const tinygltf::Model& model, int index, const std::string& place) {
    if (index < 0 || std::size_t(index) >= model.accessors.size()) {
        throw FileError(place + "accessor " + std::to_string(index) + " does not exist");
    }
    return model.accessors[std::size_t(index)];
}

// Calls put(element, component, value) for every component of every element: the base first, then what is sparse.
template <class Put>
void for_each_component(const tinygltf::Model& model, const tinygltf::Accessor& accessor, std::size_t components,
                        const std::string& place, const Put& put) {
    const std::size_t size = component_bytes(accessor.componentType);
    const auto read = [&](const View& view, std::size_t element, std::size_t target) {
        for (std::size_t c = 0; c < components; ++c) {
            put(target, c,
                component(view.data + element * view.stride + c * size, accessor.componentType, accessor.normalized));
        }
    };
    if (accessor.bufferView >= 0) {
        const View base =
            make_view(model, accessor.bufferView, accessor.byteOffset, accessor.count, components * size, false, place);
        for (std::size_t i = 0; i < base.count; ++i) read(base, i, i);
    }
    if (!accessor.sparse.isSparse) return;
    const auto& sparse = accessor.sparse;
    const std::string sparse_place = place + "sparse: ";
    if (sparse.count < 0 || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0 ||
        !is_index_type(sparse.indices.componentType)) {
        throw FileError(sparse_place + "negative count or offset, or indices of a signed type");
    }
    const View indices =
        make_view(model, sparse.indices.bufferView, std::size_t(sparse.indices.byteOffset), std::size_t(sparse.count),
                  component_bytes(sparse.indices.componentType), true, sparse_place);
    const View values = make_view(model, sparse.values.bufferView, std::size_t(sparse.values.byteOffset),
                                  std::size_t(sparse.count), components * size, true, sparse_place);
    for (std::size_t i = 0; i < indices.count; ++i) {
        const double target = component(indices.data + i * indices.stride, sparse.indices.componentType, false);
        if (target >= double(accessor.count)) throw FileError(sparse_place + "index beyond the accessor's count");
        read(values, i, std::size_t(target));
    }
}

// A missing buffer view means zeros, so a count alone could ask for any memory.
void check_count(const tinygltf::Model& model, const tinygltf::Accessor& accessor, const std::string& place) {
    constexpr std::size_t kMaxElements = std::size_t{1} << 31;
    (void)model;
    if (accessor.count > kMaxElements || (accessor.bufferView < 0 && !accessor.sparse.isSparse && accessor.count > 0)) {
        throw FileError(place + "accessor of " + std::to_string(accessor.count) +
                        " elements without data; is it compressed "
                        "by an extension? Export the file without compression");
    }
}

}  // namespace

std::vector<glm::vec3> read_vec3_accessor(const tinygltf::Model& model, int index, const std::string& place) {
    const tinygltf::Accessor& accessor = find(model, index, place);
    if (accessor.type != TINYGLTF_TYPE_VEC3 || component_bytes(accessor.componentType) == 0 ||
        accessor.componentType == TINYGLTF_COMPONENT_TYPE_DOUBLE ||
        accessor.componentType == TINYGLTF_COMPONENT_TYPE_INT) {
        throw FileError(place + "accessor " + std::to_string(index) + " is no VEC3 of a component type of glTF 2.0");
    }
    check_count(model, accessor, place);
    std::vector<glm::vec3> values(accessor.count, glm::vec3(0.0f));
    for_each_component(model, accessor, 3, place,
                       [&](std::size_t i, std::size_t c, double value) { values[i][int(c)] = float(value); });
    return values;
}

std::vector<std::uint32_t> read_index_accessor(const tinygltf::Model& model, int index, const std::string& place) {
    const tinygltf::Accessor& accessor = find(model, index, place);
    if (accessor.type != TINYGLTF_TYPE_SCALAR || !is_index_type(accessor.componentType) || accessor.normalized) {
        throw FileError(place + "accessor " + std::to_string(index) + " is no SCALAR of an unsigned type");
    }
    check_count(model, accessor, place);
    std::vector<std::uint32_t> values(accessor.count, 0);
    for_each_component(model, accessor, 1, place,
                       [&](std::size_t i, std::size_t, double value) { values[i] = std::uint32_t(value); });
    return values;
}

}  // namespace shadow_layers::io
