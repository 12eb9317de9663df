// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "shadow_layers/request.h"
#include "shadow_layers/technique_descriptor.h"

namespace shadow_layers::bindings {

namespace py = pybind11;

/// A wanted array: element type by NumPy kind ('f', 'u') and size, shape with -1 for any length.
struct ArraySpec {
    char kind;
    int item_bytes;
    std::vector<py::ssize_t> shape;
    const char* text;  ///< "float32 (n, 3)"
};

/// `value` as the array it is: nothing is converted or copied. TypeError if it is no NumPy array; InputError naming
/// the argument, what was wanted and what was got for another dtype, shape, byte order, or a gap between elements.
py::array require_array(const char* argument, const py::handle& value, const ArraySpec& spec);

/// A 4x4 matrix from anything that NumPy reads as one, row-major. Copied.
glm::dmat4 matrix_from(const char* argument, const py::handle& value);

/// `count` numbers from a sequence. InputError naming the argument.
std::vector<double> numbers_from(const char* argument, const py::handle& value, std::size_t count);

/// A whole number in [min, max], from anything with __index__.
std::int64_t integer_from(const std::string& argument, const py::handle& value, std::int64_t min, std::int64_t max);

/// 64 bits from a Python int in [0, 2**64).
std::uint64_t bits_from(const char* argument, const py::handle& value);

/// Values as given, unresolved. TypeError naming the key for anything but bool, int, float and str (NumPy's too).
ParameterValues parameters_from(const std::string& argument, const py::handle& mapping);
py::dict parameters_to(const ParameterValues& values);

/// (h, w) for one channel, else (h, w, c). Takes the pixels over: nothing is copied.
py::array array_from(Image&& image);
py::array array_from(IdImage&& image);  ///< (height, width, 2), int64
py::list times_to(const RenderStats& stats);
py::dict counters_to(const RenderStats& stats);

LightKind light_kind_from(const std::string& kind);

}  // namespace shadow_layers::bindings
