// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace tactus::golden {

bool run_meshes();  ///< false: the codec refused its input
bool run_bodies();  ///< the same of elastic bodies

}  // namespace tactus::golden
