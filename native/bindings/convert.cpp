// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "bindings/convert.h"

#include <limits>
#include <utility>

#include "shadow_layers/error.h"
#include "shadow_layers/names.h"

namespace shadow_layers::bindings {
namespace {

std::string describe(const py::array& array) {
    std::string shape = py::str(array.attr("shape"));
    std::string text = std::string(py::str(array.dtype())) + " " + shape;
    if (!(array.flags() & py::array::c_style)) text += ", not C-contiguous";
    return text;
}

bool same_shape(const py::array& array, const std::vector<py::ssize_t>& wanted) {
    if (array.ndim() != py::ssize_t(wanted.size())) return false;
    for (std::size_t axis = 0; axis < wanted.size(); ++axis) {
        if (wanted[axis] >= 0 && array.shape(py::ssize_t(axis)) != wanted[axis]) return false;
    }
    return true;
}

std::string type_name(const py::handle& value) { return Py_TYPE(value.ptr())->tp_name; }

}  // namespace

py::array require_array(const char* argument, const py::handle& value, const ArraySpec& spec) {
    if (!py::isinstance<py::array>(value)) {
        throw py::type_error(std::string(argument) + ": expected a NumPy array of " + spec.text + ", got " +
                             type_name(value));
    }
    auto array = py::reinterpret_borrow<py::array>(value);
    const py::dtype dtype = array.dtype();
    const bool native = dtype.byteorder() == '=' || dtype.byteorder() == '|';
    const bool aligned = (array.flags() & py::detail::npy_api::NPY_ARRAY_ALIGNED_) != 0;
    if (dtype.kind() != spec.kind || dtype.itemsize() != spec.item_bytes || !native || !aligned ||
        !same_shape(array, spec.shape) || !(array.flags() & py::array::c_style)) {
        throw InputError(std::string(argument) + ": expected a C-contiguous array of " + spec.text + ", got " +
                         describe(array) + (aligned ? "" : ", not aligned") +
                         "; numpy.ascontiguousarray(values, dtype) makes one");
    }
    return array;
}

glm::dmat4 matrix_from(const char* argument, const py::handle& value) {
    auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(value);
    if (!array || array.ndim() != 2 || array.shape(0) != 4 || array.shape(1) != 4) {
        PyErr_Clear();
        throw InputError(
            std::string(argument) + ": expected a 4x4 matrix of numbers, got " +
            (py::isinstance<py::array>(value) ? describe(py::reinterpret_borrow<py::array>(value)) : type_name(value)));
    }
    glm::dmat4 matrix;
    for (int row = 0; row < 4; ++row) {
        for (int column = 0; column < 4; ++column) matrix[column][row] = array.at(row, column);
    }
    return matrix;
}

std::vector<double> numbers_from(const char* argument, const py::handle& value, std::size_t count) {
    auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(value);
    if (!array || array.ndim() != 1 || std::size_t(array.shape(0)) != count) {
        PyErr_Clear();
        throw InputError(std::string(argument) + ": expected " + std::to_string(count) + " numbers, got " +
                         std::string(py::repr(value)).substr(0, 80));
    }
    return {array.data(), array.data() + count};
}

std::int64_t integer_from(const std::string& argument, const py::handle& value, std::int64_t min, std::int64_t max) {
    const auto index = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
    if (!index) {
        PyErr_Clear();
        throw py::type_error(argument + ": expected a whole number, got " + type_name(value));
    }
    int overflow = 0;
    const std::int64_t number = PyLong_AsLongLongAndOverflow(index.ptr(), &overflow);
    if (overflow != 0 || number < min || number > max) {
        throw InputError(argument + ": " + std::string(py::str(index)) + " is outside " + std::to_string(min) + " .. " +
                         std::to_string(max));
    }
    return number;
}

std::uint64_t bits_from(const char* argument, const py::handle& value) {
    const auto index = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
    if (!index) {
        PyErr_Clear();
        throw py::type_error(std::string(argument) + ": expected a whole number, got " + type_name(value));
    }
    const std::uint64_t bits = PyLong_AsUnsignedLongLong(index.ptr());
    if (PyErr_Occurred()) {
        PyErr_Clear();
        throw InputError(std::string(argument) + ": " + std::string(py::str(index)) +
                         " is not a set of 64 bits (0 .. 2**64 - 1)");
    }
    return bits;
}

ParameterValues parameters_from(const std::string& argument, const py::handle& mapping) {
    if (!PyMapping_Check(mapping.ptr()) || !py::hasattr(mapping, "items")) {
        throw py::type_error(argument + ": expected a mapping of parameter ids to values, got " + type_name(mapping));
    }
    ParameterValues values;
    for (const py::handle& item : mapping.attr("items")()) {
        const auto pair = py::reinterpret_borrow<py::tuple>(item);
        if (!py::isinstance<py::str>(pair[0])) {
            throw py::type_error(argument + ": parameter ids are strings, got " + std::string(py::repr(pair[0])));
        }
        const std::string id = py::str(pair[0]);
        const std::string place = argument + "['" + id + "']";
        const py::handle value = pair[1];
        const std::string type = type_name(value);
        if (PyBool_Check(value.ptr()) || type == "numpy.bool_" || type == "numpy.bool") {
            values.set(id, PyObject_IsTrue(value.ptr()) == 1);
        } else if (PyUnicode_Check(value.ptr())) {
            values.set(id, std::string(py::str(value)));
        } else if (PyIndex_Check(value.ptr())) {
            values.set(id, integer_from(place, value, std::numeric_limits<std::int64_t>::min(),
                                        std::numeric_limits<std::int64_t>::max()));
        } else if (PyFloat_Check(value.ptr()) || (type.starts_with("numpy.") && py::hasattr(value, "__float__"))) {
            values.set(id, py::float_(py::reinterpret_borrow<py::object>(value)).cast<double>());
        } else {
            throw py::type_error(place + ": expected bool, int, float or str, got " + type);
        }
    }
    return values;
}

py::dict parameters_to(const ParameterValues& values) {
    py::dict result;
    for (const auto& [id, value] : values.all()) {
        std::visit([&](const auto& held) { result[py::str(id)] = py::cast(held); }, value);
    }
    return result;
}

namespace {

/// The array takes over what the vector holds.
template <class T>
py::array take_array(std::vector<T>&& items, int width, int height, int channels) {
    std::vector<py::ssize_t> shape{height, width};
    if (channels != 1) shape.push_back(channels);
    if (items.size() != std::size_t(width) * std::size_t(height) * std::size_t(channels))
        throw Error("internal: an image of " + std::to_string(width) + "x" + std::to_string(height) + "x" +
                    std::to_string(channels) + " holds " + std::to_string(items.size()) + " numbers");
    auto* kept = new std::vector<T>(std::move(items));
    py::capsule owner(kept, [](void* data) { delete static_cast<std::vector<T>*>(data); });
    return py::array_t<T>(shape, kept->data(), owner);
}

}  // namespace

py::array array_from(Image&& image) {
    return take_array(std::move(image.data), image.width, image.height, image.channels);
}

py::array array_from(IdImage&& image) { return take_array(std::move(image.data), image.width, image.height, 2); }

py::list times_to(const RenderStats& stats) {
    py::list list;
    for (const StageTime& time : stats.times) {
        py::dict entry;
        entry["stage"] = time.stage;
        entry["cpu_ms"] = time.cpu_ms;
        entry["gl_ms"] = time.gl_ms;
        list.append(entry);
    }
    return list;
}

py::dict counters_to(const RenderStats& stats) {
    py::dict counters;
    for (const auto& [name, count] : stats.counters) counters[py::str(name)] = count;
    return counters;
}

LightKind light_kind_from(const std::string& kind) {
    if (const auto found = find_light_kind(kind)) return *found;
    throw InputError("kind: '" + kind + "' is no kind of light; use " + kLightKindNames);
}

}  // namespace shadow_layers::bindings
