// SPDX-License-Identifier: Apache-2.0
/// Component thesis: what Schuwerk's thesis has and profile main does not, to compare with it. Meshes of profile thesis, the
/// interpolations linear, hermite and blending of a client, and force signals (force_signal.h). spec/85-thesis.md. In a library of its own,
/// tactus::thesis; who reads or builds scenes asks for it:
///
///   auto player = tactus::Player::open(file, {.limits = {.thesis = &tactus::thesis_component}});
///
/// Without it such a scene, and such an interpolation, is refused as unsupported, and nothing of the component is linked.
#pragma once

#include <tactus/scene/scene.h>

namespace tactus {

extern const ThesisComponent thesis_component;

}  // namespace tactus
