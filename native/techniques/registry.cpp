// SPDX-FileCopyrightText: 2026 Shadow Layers contributors
// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "shadow_layers/error.h"
#include "techniques/afsm/afsm.h"
#include "techniques/edsm/edsm.h"
#include "techniques/edtsm/edtsm.h"
#include "techniques/esm/esm.h"
#include "techniques/evsm/evsm.h"
#include "techniques/exact/exact.h"
#include "techniques/extsm/extsm.h"
#include "techniques/fsasm/fsasm.h"
#include "techniques/light_samples_option.h"
#include "techniques/msm/msm.h"
#include "techniques/multi/multi.h"
#include "techniques/pcf/pcf.h"
#include "techniques/probe/probe.h"
#include "techniques/rpcf_rsmss/rpcf_rsmss.h"
#include "techniques/rpcf_smsr/rpcf_smsr.h"
#include "techniques/rsmss/rsmss.h"
#include "techniques/sm/sm.h"
#include "techniques/smsr/smsr.h"
#include "techniques/smsr2/smsr2.h"
#include "techniques/soft/soft.h"
#include "techniques/sssm/sssm.h"
#include "techniques/sv/sv.h"
#include "techniques/technique.h"
#include "techniques/vsm/vsm.h"

namespace shadow_layers {

const std::vector<TechniqueEntry>& technique_entries() {
    static const std::vector<TechniqueEntry> entries = {
        // One line per technique, in menu order.
        // clang-format off
        {describe_sm, make_sm},
        {describe_pcf, make_pcf},
        {describe_edsm, make_edsm},
        {describe_sssm, make_sssm},
        {describe_sv, make_sv},
        {describe_extsm, make_extsm},
        {describe_vsm, make_vsm},
        {describe_esm, make_esm},
        {describe_evsm, make_evsm},
        {describe_msm, make_msm},
        {describe_smsr, make_smsr},
        {describe_smsr2, make_smsr2},
        {describe_rsmss, make_rsmss},
        {describe_rpcf_smsr, make_rpcf_smsr},
        {describe_rpcf_rsmss, make_rpcf_rsmss},
        {describe_edtsm, make_edtsm},
        {describe_multi, make_multi},
        {describe_exact, make_exact},
        {describe_soft, make_soft},
        {describe_afsm, make_afsm},
        {describe_fsasm, make_fsasm},
        {describe_probe, make_probe},
        // clang-format on
    };
    return entries;
}

TechniqueDescriptor make_descriptor(const TechniqueEntry& entry) {
    TechniqueDescriptor descriptor = entry.describe();
    if (can_average_light_samples(descriptor)) add_light_samples_option(descriptor);
    return descriptor;
}

const std::vector<TechniqueDescriptor>& technique_descriptors() {
    static const std::vector<TechniqueDescriptor> descriptors = [] {
        std::vector<TechniqueDescriptor> made;
        for (const TechniqueEntry& entry : technique_entries()) made.push_back(make_descriptor(entry));
        return made;
    }();
    return descriptors;
}

const TechniqueDescriptor& find_technique_descriptor(std::string_view id) {
    return find_technique_descriptor(technique_descriptors(), id);
}

const TechniqueDescriptor& find_technique_descriptor(const std::vector<TechniqueDescriptor>& among,
                                                     std::string_view id) {
    const auto it = std::find_if(among.begin(), among.end(), [&](const auto& d) { return d.id == id; });
    if (it != among.end()) return *it;
    std::string known;
    for (const auto& d : among)
        if (!d.test_only) known += (known.empty() ? "" : ", ") + d.id;
    throw InputError("there is no technique \"" + std::string(id) + "\"; the techniques are: " + known);
}

}  // namespace shadow_layers
