// SPDX-License-Identifier: Apache-2.0
#include <tactus/thesis/thesis.h>

#include <tactus/scene/thesis_component.h>
#include <tactus/thesis/interpolation.h>
#include <tactus/thesis/thesis_decoder.h>
#include <tactus/thesis/thesis_encoder.h>

namespace tactus {

const ThesisComponent thesis_component{.decoder = thesis_mesh_decoder,
                                       .encoder = thesis_mesh_encoder,
                                       .largest_packet = largest_thesis_packet,
                                       .interpolation = thesis_interpolation};

}  // namespace tactus
