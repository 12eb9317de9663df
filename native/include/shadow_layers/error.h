// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>
#include <string>

namespace shadow_layers {

/// Base of everything the core throws. One C++ class maps to one Python class of the same name.
/// The text names the culprit, the value met, and the remedy.
class Error : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// The caller gave data that cannot be rendered: a scene, camera, light, parameter or request.
class InputError : public Error {
public:
    using Error::Error;
};

/// No GL context could be made; the text lists each back end tried, why it failed and what to install.
class ContextError : public Error {
public:
    using Error::Error;
};

/// A shader file is missing, or does not compile or link; the text holds file:line of the source.
class ShaderError : public Error {
public:
    using Error::Error;
};

/// The driver refused: a limit exceeded, out of memory, or a GL error after a stage.
class DriverError : public Error {
public:
    using Error::Error;
};

/// A file could not be read or written (io/ and cli/ only).
class FileError : public Error {
public:
    using Error::Error;
};

/// Session::cancel() was called. Not a failure: nothing of the cancelled frame is returned.
class Cancelled : public Error {
public:
    Cancelled() : Error("the render was cancelled") {}
};

}  // namespace shadow_layers
