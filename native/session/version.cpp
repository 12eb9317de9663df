// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include "shadow_layers/session.h"

namespace shadow_layers {

const char* version() { return SHADOW_LAYERS_VERSION; }
const char* revision() { return SHADOW_LAYERS_REVISION; }

}  // namespace shadow_layers
