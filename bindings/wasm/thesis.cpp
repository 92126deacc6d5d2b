// SPDX-License-Identifier: Apache-2.0
/// Component thesis of a module that only decodes.
#include <tactus/thesis/thesis.h>

#include <tactus/scene/thesis_component.h>
#include <tactus/thesis/interpolation.h>
#include <tactus/thesis/thesis_decoder.h>

namespace tactus {

const ThesisComponent thesis_component{
    .decoder = thesis_mesh_decoder, .encoder = nullptr, .largest_packet = nullptr, .interpolation = thesis_interpolation};

}  // namespace tactus
