// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "context/context.h"
#include "context/shared_library.h"
#include "shadow_layers/error.h"

namespace shadow_layers {
namespace {

// The few names of GL/osmesa.h that are used, so that the header isn't needed where Mesa no longer has it (25.1 on).
struct OSMesaState;
using OSMesaHandle = OSMesaState*;
constexpr int kFormat = 0x22, kDepthBits = 0x30, kStencilBits = 0x31, kProfile = 0x33, kCoreProfile = 0x34,
              kMajorVersion = 0x36, kMinorVersion = 0x37, kRGBA = 0x1908, kUnsignedByte = 0x1401;

class OSMesaContext final : public Context {
public:
    OSMesaContext() : library_({"libOSMesa.so.8", "libOSMesa.so", "libOSMesa.so.6"}) {
        create_ = library_.function<Create>("OSMesaCreateContextAttribs");
        destroy_ = library_.function<Destroy>("OSMesaDestroyContext");
        make_current_ = library_.function<MakeCurrent>("OSMesaMakeCurrent");
        load_ = library_.function<Load>("OSMesaGetProcAddress");
        const int attributes[] = {kFormat,  kRGBA,        kDepthBits,    0, kStencilBits,  0,
                                  kProfile, kCoreProfile, kMajorVersion, 4, kMinorVersion, 5,
                                  0};
        handle_ = create_(attributes, nullptr);
        if (!handle_) throw ContextError(library_.name() + " cannot make an OpenGL 4.5 core context");
        if (!bind()) {
            destroy_(handle_);
            throw ContextError(library_.name() + " cannot make its context current");
        }
    }
    ~OSMesaContext() override {
        make_current_(nullptr, nullptr, 0, 0, 0);
        destroy_(handle_);
    }
    void make_current() override {
        if (!bind()) throw ContextError(library_.name() + " cannot make its context current");
    }
    Function load(const char* name) override { return load_(name); }
    const std::string& description() const override { return description_; }
    bool software() const override { return true; }

private:
    using Create = OSMesaHandle (*)(const int*, OSMesaHandle);
    using Destroy = void (*)(OSMesaHandle);
    using MakeCurrent = unsigned char (*)(OSMesaHandle, void*, unsigned, int, int);
    using Load = Function (*)(const char*);

    // OSMesa wants a picture to draw on, though all drawing here goes to framebuffer objects.
    bool bind() { return make_current_(handle_, pixel_, kUnsignedByte, 1, 1) != 0; }

    SharedLibrary library_;
    Create create_;
    Destroy destroy_;
    MakeCurrent make_current_;
    Load load_;
    OSMesaHandle handle_ = nullptr;
    alignas(16) unsigned char pixel_[16] = {};
    std::string description_ = "osmesa";
};

}  // namespace

std::unique_ptr<Context> make_osmesa_context() { return std::make_unique<OSMesaContext>(); }

}  // namespace shadow_layers
